// Restitution by Newton's law: points leave with a part of the speed that they came with. At several points at once,
// with friction, or where a body is hit here and then there within a step, that law alone may give back more than was
// taken; so the work of each contact's normal impulses is summed over the step, and a bounce gives back what they took
// at most (W. J. Stronge, Impact Mechanics, 2000).
#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

namespace fulcrum {

namespace {

using namespace contacts;

constexpr int kPasses = 8;  // whatever the number of points: lanes of a batch have more or fewer

// The changes of impulses that make the points which were hit part with their bounce speeds, all of a contact at once.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void FindBounces(const ContactBatch<N, kFixedB>& batch, const NormalMotion<Wide<N>>& motion,
                                      Wide<N> (&changes)[ContactRecord::kMaxPoints]) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    Real missing[ContactRecord::kMaxPoints];  // m/s
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        missing[i] = MotionOf(row, motion) - batch.bounceSpeed[i];
        changes[i] = zero;
    }
    for (int pass = 0; pass < kPasses; ++pass)
        for (int i = 0; i < batch.pointCount; ++i) {
            const auto& row = batch.rows[i];
            const auto hit = (batch.bounceSpeed[i] > zero) & (batch.largestImpulse[i] > zero);
            const Real wanted = Max(changes[i] - row.inverseResponse * missing[i], -row.impulse);
            const Real change = Select(hit, wanted - changes[i], zero);
            changes[i] += change;
            missing[i] += Select(row.inverseResponse > zero, change / row.inverseResponse, zero);
            for (int j = 0; j < batch.pointCount; ++j)
                if (j != i) missing[j] += batch.response[i < j ? PairIndex(i, j) : PairIndex(j, i)] * change;
        }
}

// The part of impulses that does work `most`, where all of it does more: of work = rate part + rest part^2 with rest >=
// 0.
template <class Real>
FULCRUM_FORCE_INLINE Real PartWithin(Real most, Real rate, Real all) {
    const Real zero(0.0f), rest = Max(all - rate, zero), root = Sqrt(Max(rate * rate + Real(4.0f) * rest * most, zero));
    // Of the two forms of the solution the one that takes no difference.
    const Real forwards = Real(2.0f) * most / Max(rate + root, Real(1e-30f)),
               backwards = (root - rate) / Max(Real(2.0f) * rest, Real(1e-30f));
    return Select(all > most, Clamp(Select(rate > zero, forwards, backwards), zero, Real(1.0f)), Real(1.0f));
}

}  // namespace

template <int N, bool kFixedB>
void NoteCarriedWork(ContactBatch<N, kFixedB>& batch, BodyState* states, const float* freeRows, float elapsed) {
    if (!batch.bounces) return;
    const auto freeRow = [&](uint32_t body) { return freeRows + 8 * size_t(body); };
    Twists<N, kFixedB> carried, free;
    Gather<BodyRow::Velocity>(batch, states, carried);
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = freeRow(batch.bodyA[i]);
    GatherRows<N>(rows, free.a);
    if constexpr (!kFixedB) {
        for (int i = 0; i < N; ++i) rows[i] = freeRow(batch.sideB.body[i]);
        GatherRows<N>(rows, free.b);
    }
    const auto motionOf = [&](const Twists<N, kFixedB>& twists) {
        return NormalMotionOf(batch, RelativeTwist<BodyRow::Velocity>(batch, twists, elapsed));
    };
    NoteWork(batch, TotalOf(batch), motionOf(free), motionOf(carried));
}

// Gravity does m a (v + a h / 2) h on a body that falls at v, but it moves with the impulse's change dv of its velocity
// as well, and loses m a (v + a h + dv) h of its potential. As if it had been hit at the beginning of the substep, it
// is higher than it should be: by an energy of -m a dv h, of both bodies `closing` h times the impulse. The other m a^2
// h^2 / 2 is lost in any case; the first point's effective mass is no more than that of the bodies.
template <int N, bool kFixedB>
void NoteLift(ContactBatch<N, kFixedB>& batch, float h) {
    if (!batch.bounces) return;
    using Real = Wide<N>;
    const Real gain = batch.closing * Real(h);
    batch.work += gain * (TotalOf(batch).sum - Real(0.5f) * batch.rows[0].inverseResponse * gain);
}

template <int N, bool kFixedB>
void RestituteContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, float elapsed) {
    if (!batch.bounces) return;
    using Real = Wide<N>;
    const Real zero(0.0f);
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Velocity>(batch, states, twists);
    const auto motionOf = [&](const Twists<N, kFixedB>& of) {
        return NormalMotionOf(batch, RelativeTwist<BodyRow::Velocity>(batch, of, elapsed));
    };
    const NormalMotion<Real> motion = motionOf(twists);
    Real changes[ContactRecord::kMaxPoints];
    FindBounces(batch, motion, changes);
    NormalImpulses<Real> bounce;
    for (int i = 0; i < batch.pointCount; ++i) bounce.Add(batch.rows[i], changes[i]);

    Twists<N, kFixedB> all = twists;
    ApplyToBoth<N, kFixedB>(batch, all, batch.normal * bounce.sum, NormalTorque(batch, bounce.sumA, bounce.sumB));
    const Real rate = WorkOf(bounce, motion), work = Real(0.5f) * (rate + WorkOf(bounce, motionOf(all)));
    const Real part = PartWithin(Max(-batch.work, zero), rate, work);
    for (int i = 0; i < batch.pointCount; ++i)
        batch.rows[i].impulse = Max(batch.rows[i].impulse + changes[i] * part, zero);
    // Lanes without a bounce keep every bit, as they do where their batch has no bouncing neighbor.
    const auto still = bounce.sum == zero;
    for (int k = 0; k < 6; ++k) {
        all.a[k] = Select(still, twists.a[k], twists.a[k] + (all.a[k] - twists.a[k]) * part);
        if constexpr (!kFixedB) all.b[k] = Select(still, twists.b[k], twists.b[k] + (all.b[k] - twists.b[k]) * part);
    }
    Scatter(batch, all);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                        \
    template void NoteCarriedWork(ContactBatch<lanes, fixedB>&, BodyState*, const float*, float); \
    template void NoteLift(ContactBatch<lanes, fixedB>&, float);                                  \
    template void RestituteContacts(ContactBatch<lanes, fixedB>&, BodyState*, float);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
