#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

namespace fulcrum {

using namespace contacts;

template <int N, bool kFixedB>
void PullContacts(const ContactBatch<N, kFixedB>& batch, BodyState* pseudo, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f), inverseDt(settings.inverseDt);
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Velocity>(batch, pseudo, twists);
    // Static and kinematic bodies have no pseudo-velocity, and their displacement is that of the start of the step.
    const NormalMotion<Real> motion = NormalMotionOf(batch, RelativeTwist<BodyRow::Displacement>(batch, twists, 0));
    Real speed[ContactRecord::kMaxPoints];
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        speed[i] = MotionOf(row, motion) + Max(row.separation, zero) * inverseDt;
    }
    NormalImpulses<Real> changes;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        const Real change = Max(-row.inverseResponse * speed[i], zero);
        for (int j = i + 1; j < batch.pointCount; ++j) speed[j] += batch.response[PairIndex(i, j)] * change;
        changes.Add(row, change);
    }
    ApplyToBoth<N, kFixedB>(batch, twists, batch.normal * changes.sum, NormalTorque(batch, changes.sumA, changes.sumB));
    if constexpr (kFixedB) twists.a[BodyState::kNearFixed] = Real(1.0f);
    Scatter(batch, twists);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB) \
    template void PullContacts(const ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
