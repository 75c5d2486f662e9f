// What one contact of a body gave, another must not give back: where pushes at one have done work, the bounces at others have so much less to
// spend. Called by Solve before restitution, a colour after the other, each function over all batches before the next. `rows` has eight
// floats a body, of which the last holds what is still due, J.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>

#include <algorithm>

namespace fulcrum {

inline constexpr size_t kDueOf = 7;

// Calls visit(lane, due to A, due to B or null) for the contacts of a batch with restitution.
template <int N, bool kFixedB, class Visit>
void VisitDebts(const ContactBatch<N, kFixedB>& batch, float* rows, Visit&& visit) {
    if (!batch.bounces) return;
    for (int i = 0; i < batch.count; ++i) {
        float* dueB = nullptr;
        if constexpr (!kFixedB) dueB = rows + 8 * size_t(batch.sideB.body[i]) + kDueOf;
        visit(i, rows + 8 * size_t(batch.bodyA[i]) + kDueOf, dueB);
    }
}

template <int N, bool kFixedB>
void ForgetDebts(const ContactBatch<N, kFixedB>& batch, float* rows) {
    VisitDebts(batch, rows, [](int, float* a, float* b) {
        *a = 0;
        if (b) *b = 0;
    });
}

// Contacts that have given energy owe it to their bodies.
template <int N, bool kFixedB>
void NoteDebts(const ContactBatch<N, kFixedB>& batch, float* rows) {
    VisitDebts(batch, rows, [&](int i, float* a, float* b) {
        const float given = std::max(batch.work[i], 0.0f);
        *a += given;
        if (b) *b += given;
    });
}

// Those that have taken some pay.
template <int N, bool kFixedB>
void PayDebts(ContactBatch<N, kFixedB>& batch, float* rows) {
    alignas(64) float work[N];
    batch.work.Store(work);
    VisitDebts(batch, rows, [&](int i, float* a, float* b) {
        for (float* due : {a, b}) {
            if (!due) continue;
            const float paid = std::clamp(-work[i], 0.0f, *due);
            work[i] += paid;
            *due -= paid;
        }
    });
    batch.work = Wide<N>::Load(work);
}

}  // namespace fulcrum
