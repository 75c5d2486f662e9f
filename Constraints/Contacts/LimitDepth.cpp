#include <Fulcrum/Constraints/Contacts/ContactLanes.h>

#include <cmath>

namespace fulcrum {

using namespace contacts;

namespace {

// Rows are linear in small rotations, and tell nothing of larger ones. Also false if something is not finite.
bool IsSmall(const Wide<1> (&before)[8], const Wide<1> (&after)[8]) {
    constexpr float kMost = 1;  // rad
    const Vec3<Wide<1>> moved = Linear(after) - Linear(before), turned = Angular(after) - Angular(before);
    return Dot<Wide<1>>(turned, turned)[0] <= kMost * kMost && std::isfinite(Dot<Wide<1>>(moved, moved)[0]);
}

}  // namespace

template <int N, bool kFixedB>
bool LimitDepth(ContactBatch<N, kFixedB>& batch, int lane, BodyState* states, const ContactSolveSettings& settings) {
    using Real = Wide<1>;
    ContactBatch<1, kFixedB> single;
    ReadLane(batch, lane, single);
    const Real perDepth = Real(single.inverseSoftDepth);
    Twists<1, kFixedB> twists;
    Gather<BodyRow::Displacement>(single, states, twists);
    const NormalMotion<Real> motion =
        NormalMotionOf(single, RelativeTwist<BodyRow::Displacement>(single, twists, settings.elapsed));
    Real missing[ContactRecord::kMaxPoints];  // m
    bool isDeep = false;
    for (int i = 0; i < single.pointCount; ++i) {
        const auto& row = single.rows[i];
        const Real separation = row.startSeparation + MotionOf(row, motion);
        batch.rows[i].separation.Set(lane, separation[0]);
        const Real tooDeep = DepthLimitOf<Real>(row.startSeparation * perDepth) - separation * perDepth;
        isDeep = isDeep || (tooDeep[0] > kLeastDeepening && row.inverseResponse[0] > 0);
        missing[i] = tooDeep / perDepth;
    }
    if (!isDeep) return false;
    const NormalImpulses<Real> impulses = SweepMissing(single, missing);
    const Twists<1, kFixedB> before = twists;
    ApplyToBoth<1, kFixedB>(single, twists, single.normal * impulses.sum,
                            NormalTorque(single, impulses.sumA, impulses.sumB));
    if (!IsSmall(before.a, twists.a)) return false;
    if constexpr (!kFixedB)
        if (!IsSmall(before.b, twists.b)) return false;
    SetHalfTurn<Real>(twists.a);
    if constexpr (!kFixedB) SetHalfTurn<Real>(twists.b);
    Scatter(single, twists);
    return true;
}

#define FULCRUM_INSTANTIATE(lanes, fixedB) \
    template bool LimitDepth(ContactBatch<lanes, fixedB>&, int, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
