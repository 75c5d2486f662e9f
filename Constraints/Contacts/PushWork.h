// Energy that pushes at one contact of a body gave must not be given a second time by bounces at its others: these have
// so much less to give back. Called by Solve before restitution, a color after the other, each function over all
// batches before the next. `rows` has eight floats a body, of which the last holds what pushes gave and no bounce has
// left out yet, J.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>

#include <algorithm>

namespace fulcrum {

inline constexpr size_t kPushWork = 7;

// Calls visit(lane, push work of A, of B or null) for the contacts of a batch with restitution, whatever others share
// it.
template <int N, bool kFixedB, class Visit>
void VisitPushWork(const ContactBatch<N, kFixedB>& batch, float* rows, Visit&& visit) {
    if (!batch.bounces) return;
    for (int i = 0; i < batch.count; ++i) {
        if (!(batch.restitution[i] > 0.0f)) continue;
        float* ofB = nullptr;
        if constexpr (!kFixedB) ofB = rows + 8 * size_t(batch.sideB.body[i]) + kPushWork;
        visit(i, rows + 8 * size_t(batch.bodyA[i]) + kPushWork, ofB);
    }
}

template <int N, bool kFixedB>
void ClearPushWork(const ContactBatch<N, kFixedB>& batch, float* rows) {
    VisitPushWork(batch, rows, [](int, float* a, float* b) {
        *a = 0;
        if (b) *b = 0;
    });
}

// Of contacts that have done positive work.
template <int N, bool kFixedB>
void AddPushWork(const ContactBatch<N, kFixedB>& batch, float* rows) {
    VisitPushWork(batch, rows, [&](int i, float* a, float* b) {
        const float given = std::max(batch.work[i], 0.0f);
        *a += given;
        if (b) *b += given;
    });
}

// From what contacts have taken, and may give back.
template <int N, bool kFixedB>
void SubtractPushWork(ContactBatch<N, kFixedB>& batch, float* rows) {
    if (!batch.bounces) return;
    alignas(64) float work[N];
    batch.work.Store(work);
    VisitPushWork(batch, rows, [&](int i, float* a, float* b) {
        for (float* given : {a, b}) {
            if (!given) continue;
            const float part = std::clamp(-work[i], 0.0f, *given);
            work[i] += part;
            *given -= part;
        }
    });
    batch.work = Wide<N>::Load(work);
}

}  // namespace fulcrum
