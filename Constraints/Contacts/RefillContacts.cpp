#include <Fulcrum/Constraints/Contacts/ContactLanes.h>

#include <algorithm>

namespace fulcrum {

namespace {

using namespace contacts;

// The impulses of the rows are applied to the bodies' velocities without the warm start: `sign` 1 takes them out of the
// warm start, -1 adds them to it.
template <bool kFixedB>
void MoveOutOfWarmStart(const ContactBatch<1, kFixedB>& single, float* freeA, float* freeB, float sign) {
    using Real = Wide<1>;
    Twists<1, kFixedB> twists;
    twists.rowsA[0] = freeA;
    GatherRows<1>(reinterpret_cast<const float* const(&)[1]>(twists.rowsA), twists.a);
    if constexpr (!kFixedB) {
        twists.rowsB[0] = freeB;
        GatherRows<1>(reinterpret_cast<const float* const(&)[1]>(twists.rowsB), twists.b);
    }
    const Real factor(sign);
    const NormalImpulses<Real> normal = TotalOf(single);
    const auto* f = single.frictionImpulse;
    const Vec3<Real> force = single.normal * normal.sum + single.tangent1 * f[0] + single.tangent2 * f[1],
                     torque = NormalTorque(single, normal.sumA, normal.sumB) + single.normal * f[2];
    ApplyToBoth<1, kFixedB>(single, twists, force * factor, torque * factor);
    Scatter(single, twists);
}

template <class Real>
void ClearRow(auto& row) {
    row.a = row.b = row.inverseResponse = row.startSeparation = row.separation = row.impulse = Real(0.0f);
}

}  // namespace

template <int N, bool kFixedB>
void RefillContact(ContactBatch<N, kFixedB>& batch, int lane, const ContactRecord* records,
                   const ConstSolverBodies& bodies, float* freeA, float* freeB, const ContactPrepareSettings& settings,
                   float elapsed) {
    using Real = Wide<1>;
    ContactBatch<1, kFixedB> before{}, after{};
    ReadLane(batch, lane, before);
    after.count = 1;
    MoveOutOfWarmStart(before, freeA, freeB, 1.0f);
    const ContactRecord& record = records[batch.contact[lane]];
    if (record.Has(ContactRecord::kApart)) {
        after = before;
        for (auto& row : after.rows) ClearRow<Real>(row);
        for (Real& impulse : after.frictionImpulse) impulse = Real(0.0f);
    } else {
        after.contact[0] = batch.contact[lane];
        after.bodyA[0] = 0;
        after.bodyB[0] = 1;
        PrepareContacts<1, kFixedB>(after, records, bodies, settings);
        if (after.isGuided) LimitGuidedPushes(after);
        // Velocities are those at the start of the step. A listener gave its surface velocity then: it stays.
        if constexpr (kFixedB) {
            auto& side = after.sideB;
            if (record.Has(ContactRecord::kSurfaceVelocity)) side = before.sideB;
            else side.velocity.linear -= side.acceleration * Real(elapsed);
        }
        // The rows refer to displacements since the start of the step.
        Twists<1, kFixedB> twists;
        for (int k = 0; k < 8; ++k) {
            twists.a[k] = Real(bodies.states[0].PoseRow()[k]);
            if constexpr (!kFixedB) twists.b[k] = Real(bodies.states[1].PoseRow()[k]);
        }
        const NormalMotion<Real> moved =
            NormalMotionOf(after, RelativeTwist<BodyRow::Displacement>(after, twists, elapsed));
        for (int i = 0; i < after.pointCount; ++i) after.rows[i].startSeparation -= MotionOf(after.rows[i], moved);
        for (int i = after.pointCount; i < ContactRecord::kMaxPoints; ++i) ClearRow<Real>(after.rows[i]);
    }
    MoveOutOfWarmStart(after, freeA, freeB, -1.0f);
    // Rows that no lane had.
    for (; batch.pointCount < after.pointCount; ++batch.pointCount) {
        const int i = batch.pointCount;
        ClearRow<Wide<N>>(batch.rows[i]);
        for (int j = 0; j < i; ++j) batch.response[PairIndex(j, i)] = Wide<N>(0.0f);
    }
    // Another triangle may have another restitution.
    batch.bounces |= after.bounces;
    VisitLane(batch, lane, after, [](void* to, const void* from) { std::memcpy(to, from, sizeof(float)); });
    batch.collisions[lane] = static_cast<uint8_t>(std::min(batch.collisions[lane] + 1, 255));
    batch.hasCollidedAgain = true;
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                         \
    template void RefillContact(ContactBatch<lanes, fixedB>&, int, const ContactRecord*, const ConstSolverBodies&, \
                                float*, float*, const ContactPrepareSettings&, float);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
