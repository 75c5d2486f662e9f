#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum {

namespace {

using namespace contacts;

// Finds the lanes whose bodies have moved farther relative to each other since they collided last. moved: since the
// start of the step.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void FindOutdated(ContactBatch<N, kFixedB>& batch, const Twist<Wide<N>>& moved) {
    using Real = Wide<N>;
    const uint32_t used = LanesOf(batch);
    Real arm = Dot<Real>(batch.armA, batch.armA);
    if constexpr (!kFixedB) arm = Max(arm, Dot<Real>(batch.sideB.arm, batch.sideB.arm));
    const Real perRadius = batch.inverseSoftDepth * batch.inverseSoftDepth;
    Real collisions(1.0f);  // their number, squared
    if (batch.hasCollidedAgain) [[unlikely]]
        for (int lane = 0; lane < N; ++lane) {
            const float times = batch.collisions[lane];
            collisions.Set(lane, times * times);
        }
    // t^2 r > 2 kMostDeviation times the inner radius, squared.
    const Real angle = Dot<Real>(moved.angular, moved.angular),
               most = collisions * Real(2 * kMostDeviation / kSoftFraction);
    batch.rotated = static_cast<uint16_t>((angle * angle * arm * perRadius > most * most).ToBits() & used);
    if constexpr (kFixedB) {
        const Real along = Dot<Real>(moved.linear, batch.normal);
        const Real distance = Dot<Real>(moved.linear, moved.linear) - along * along;
        constexpr float kMost = kMostSliding / kSoftFraction;
        const auto slid = distance * perRadius > collisions * Real(kMost * kMost);
        batch.slid = static_cast<uint16_t>(slid.ToBits() & used);
    }
}

}  // namespace

void ContactSolveSettings::Soften(float frequency, float dampingRatio, float h, float itsMaxPushSpeed) {
    const PushSoftness push = PushSoftnessOf(frequency, dampingRatio, h);
    maxPushSpeed = itsMaxPushSpeed;
    pushRate = push.pushRate;
    massScale = push.softness.massScale;
    impulseScale = push.softness.impulseScale;
    constexpr float kSoftest = 0.125f;  // least softness: keeps impulses bounded
    mostStiffer = (1 - kSoftest) * impulseScale;
    stiffening = impulseScale / maxPushSpeed;
}

void ContactSolveSettings::StopRecovery() {
    pushRate = impulseScale = stiffening = mostStiffer = 0;
    massScale = 1;
    relaxes = false;
}

template <int N, bool kFixedB>
void WarmStartContacts(ContactBatch<N, kFixedB>& batch, BodyState* states) {
    WarmStartRows(batch, states);
}

// Of gaps, of a side that moves by itself, of surface velocities; not of overlaps, whose recovery is not kept.
template <int N, bool kFixedB>
void AddWarmStart(const ContactBatch<N, kFixedB>& batch, WarmStart* starts, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    const auto [force, torque] = TotalWrench(batch);
    Real work(0.0f);
    for (int i = 0; i < batch.pointCount; ++i)
        work += batch.rows[i].impulse * Max(batch.rows[i].separation, Real(0.0f)) * Real(settings.inverseDt);
    uint32_t bodyB[N];
    uint32_t fixedB = 0;
    Vec3<Real> armB;
    if constexpr (kFixedB) {
        const Twist<Real>& velocity = batch.sideB.velocity;
        work += Dot<Real>(force, velocity.linear + batch.sideB.acceleration * Real(settings.elapsed)) +
                Dot<Real>(torque, velocity.angular);
        for (int i = 0; i < N; ++i) bodyB[i] = batch.bodyA[i];
        fixedB = ~0u;
    } else {
        for (int i = 0; i < N; ++i) bodyB[i] = batch.bodyB[i];
        armB = batch.sideB.arm;
        if (batch.hasSurface) {
            const SurfaceMotion<Real> surface = GatherSurfaceMotion(batch, settings.rare->surfaceVelocities);
            const auto* f = batch.frictionImpulse;
            work += f[0] * surface.v1 + f[1] * surface.v2 + f[2] * surface.spin;
        }
    }
    const Twist<Real> onA{-force, -(Cross<Real>(batch.armA, force) + torque)},
        onB{force, Cross<Real>(armB, force) + torque};
    AddWarmStart<N>(starts, batch.bodyA, bodyB, batch.count, 0, fixedB, onA, onB, Vec2<Real>(work, Real(0.0f)));
}

template <int N, bool kFixedB>
void ScaleImpulses(ContactBatch<N, kFixedB>& batch, const WarmStart* starts) {
    const Wide<N> scale = GatherScale<N>(starts, batch.bodyA, batch.bodyA, 0);
    for (int i = 0; i < batch.pointCount; ++i) batch.rows[i].impulse = batch.rows[i].impulse * scale;
    for (int k = 0; k < 3; ++k) batch.frictionImpulse[k] = batch.frictionImpulse[k] * scale;
}

template <int N, bool kFixedB>
void SolveContactVelocities(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    if (settings.relaxes && !MovesByItself(batch).Any()) SolveAllRows<Pass::Push>(batch, states, settings);
    else SolveAllRows<Pass::PushAndFriction>(batch, states, settings);
}

template <int N, bool kFixedB>
void UpdateSeparations(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Displacement>(batch, states, twists);
    const Twist<Real> moved = RelativeTwist<BodyRow::Displacement>(batch, twists, settings.elapsed);
    const NormalMotion<Real> motion = NormalMotionOf(batch, moved);
    const Real zero(0.0f), perDepth = batch.inverseSoftDepth;
    WideMask<N> isDeep = zero > zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        row.separation = row.startSeparation + MotionOf(row, motion);
        const Real limit = DepthLimitOf<Real>(row.startSeparation * perDepth) - Real(kLeastDeepening);
        isDeep = isDeep | ((row.separation * perDepth < limit) & (row.inverseResponse > zero));
    }
    batch.deepened = static_cast<uint16_t>(isDeep.ToBits() & LanesOf(batch));
    FindOutdated(batch, moved);
}

template <int N, bool kFixedB>
void RelaxContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    UpdateSeparations(batch, states, settings);
    SolveAllRows<Pass::Relax>(batch, states, settings);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                       \
    template void WarmStartContacts(ContactBatch<lanes, fixedB>&, BodyState*);                                   \
    template void AddWarmStart(const ContactBatch<lanes, fixedB>&, WarmStart*, const ContactSolveSettings&);     \
    template void ScaleImpulses(ContactBatch<lanes, fixedB>&, const WarmStart*);                                 \
    template void SolveContactVelocities(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&); \
    template void RelaxContacts(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);          \
    template void UpdateSeparations(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
