#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Constraints/Joints/JointKernels.h>

namespace fulcrum {

namespace {

using namespace joints;

template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Times(const Real& inertia, const Vec3<Real>& v) {
    return Vec3<Real>(v * inertia);
}
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Times(const Sym3<Real>& inertia, const Vec3<Real>& v) {
    return inertia * v;
}

// The inverse inertias of a batch: scalars if it is round, else tensors.
template <bool kRound, int N>
FULCRUM_FORCE_INLINE const auto& InertiaOfA(const BallBatch<N>& batch) {
    if constexpr (kRound) return batch.inverseInertiaA;
    else return batch.inertiaA;
}
template <bool kRound, int N>
FULCRUM_FORCE_INLINE const auto& InertiaOfB(const BallBatch<N>& batch) {
    if constexpr (kRound) return batch.inverseInertiaB;
    else return batch.inertiaB;
}

template <bool kRound, int N>
void GatherMasses(BallBatch<N>& batch, const BodyMass* masses) {
    UniformInverseMass<Wide<N>> a, b;
    const auto turning =
        TurningLanes<N>(GatherMass<N>(batch.bodyA, masses, a)) | TurningLanes<N>(GatherMass<N>(batch.bodyB, masses, b));
    batch.turning = turning.Any();
    batch.turns = Select(turning, Wide<N>(1.0f), Wide<N>(0.0f));
    batch.inverseMassA = a.mass;
    batch.inverseMassB = b.mass;
    if constexpr (kRound) {
        batch.inverseInertiaA = a.inertia.xx;
        batch.inverseInertiaB = b.inertia.xx;
    } else {
        batch.inertiaA = a.inertia;
        batch.inertiaB = b.inertia;
    }
}

// Applies an impulse at the arms to the velocities.
template <bool kRound, int N>
FULCRUM_FORCE_INLINE void AddImpulse(const BallBatch<N>& batch, const Vec3<Wide<N>>& armA, const Vec3<Wide<N>>& armB,
                                     const Vec3<Wide<N>>& impulse, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    a.linear -= impulse * batch.inverseMassA;
    a.angular -= Times<Real>(InertiaOfA<kRound>(batch), Cross<Real>(armA, impulse));
    b.linear += impulse * batch.inverseMassB;
    b.angular += Times<Real>(InertiaOfB<kRound>(batch), Cross<Real>(armB, impulse));
}

// The same for a change of the accumulated impulse; NaN counts as zero, so that one bad joint cannot spread NaN to
// bodies.
template <bool kRound, int N>
FULCRUM_FORCE_INLINE void Change(BallBatch<N>& batch, const Vec3<Wide<N>>& armA, const Vec3<Wide<N>>& armB,
                                 const Vec3<Wide<N>>& change, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    const auto acts = Abs(change.x()) + Abs(change.y()) + Abs(change.z()) > Real(0.0f);
    const Vec3<Real> impulse = ZeroUnless<Real>(acts, change);
    batch.impulse += impulse;
    AddImpulse<kRound>(batch, armA, armB, impulse, a, b);
}

// The arms of the joints, and the offsets from the anchors of A to those of B.
template <class Real>
struct BallPlace {
    Vec3<Real> armA, armB, offset;
};

// Moves the arms to the point at which impulses act.
template <int N>
FULCRUM_FORCE_INLINE void MoveArmsToImpulsePoint(const BallBatch<N>& batch, BallPlace<Wide<N>>& place) {
    using Real = Wide<N>;
    const Real share = ImpulsePointFraction<N>(batch.fixedA, batch.fixedB);
    const Vec3<Real> between = WithinArms<Real>(place.offset, place.armA, place.armB);
    place.armA += between * share;
    place.armB -= between * (Real(1.0f) - share);
}

template <bool kRound, int N>
FULCRUM_FORCE_INLINE Sym3<Wide<N>> MassAt(const BallBatch<N>& batch, const Vec3<Wide<N>>& armA,
                                          const Vec3<Wide<N>>& armB) {
    using Real = Wide<N>;
    if constexpr (kRound) {
        const Vec3<Real> a = armA * batch.inverseInertiaA, b = armB * batch.inverseInertiaB;
        const Real xx = a.x() * armA.x() + b.x() * armB.x(), yy = a.y() * armA.y() + b.y() * armB.y(),
                   zz = a.z() * armA.z() + b.z() * armB.z();
        const Real mass = batch.inverseMassA + batch.inverseMassB;
        Sym3<Real> k;
        k.xx = mass + (yy + zz);
        k.yy = mass + (xx + zz);
        k.zz = mass + (xx + yy);
        k.xy = -(a.x() * armA.y() + b.x() * armB.y());
        k.xz = -(a.x() * armA.z() + b.x() * armB.z());
        k.yz = -(a.y() * armA.z() + b.y() * armB.z());
        return SymmetricInverse(k);
    } else {
        const InverseMass<Real> a{batch.inverseMassA, batch.inertiaA}, b{batch.inverseMassB, batch.inertiaB};
        return SymmetricInverse(PointInverseMass(a, b, armA, armB));
    }
}

template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> MotionAt(const Twist<Real>& a, const Twist<Real>& b, const Vec3<Real>& armA,
                                         const Vec3<Real>& armB) {
    return PointMotion(a, b, armA, armB);
}

// Rotation of a body since the start of the step: see BodyState::halfTurn.
template <int N>
FULCRUM_FORCE_INLINE Quat<Wide<N>> TurnOf(const Motion<N>& pose) {
    const Wide<N>(&r)[8] = pose.row;
    constexpr int w = BodyState::kAngular;
    const Wide<N>&sine = r[BodyState::kHalfTurn], &cosine = r[BodyState::kHalfTurn + 1];
    return {r[w] * sine, r[w + 1] * sine, r[w + 2] * sine, cosine};
}

// Arms and offset at the displaced poses.
template <int N>
FULCRUM_FORCE_INLINE BallPlace<Wide<N>> Displaced(const BallBatch<N>& batch, BodyState* states, const Motion<N>& poseA,
                                                  const Motion<N>& poseB, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    Twist<Real> a = poseA.Get(), b = poseB.Get();
    Quat<Real> turnA = TurnOf(poseA), turnB = TurnOf(poseB);
    if ((batch.kinematicA | batch.kinematicB) != 0) {
        const Velocities<N> v(batch, states);
        AddKinematicMotion<N>(a, v.a, batch.kinematicA, settings.elapsed);
        AddKinematicMotion<N>(b, v.b, batch.kinematicB, settings.elapsed);
        turnA = RotationOf<Real>(a.angular);
        turnB = RotationOf<Real>(b.angular);
    }
    BallPlace<Real> place{Rotate<Real>(turnA, batch.startArmA), Rotate<Real>(turnB, batch.startArmB), {}};
    place.offset =
        batch.startOffset + (b.linear - a.linear) + (place.armB - batch.startArmB) - (place.armA - batch.startArmA);
    return place;
}

template <int N>
FULCRUM_FORCE_INLINE void Aim(BallBatch<N>& batch, const Twist<Wide<N>>& a, const Twist<Wide<N>>& b,
                              const JointSolveSettings& settings) {
    const Arcs<Wide<N>> arcs(a, b, settings.substepDt);
    batch.aim = arcs.OfB(batch.armB) - arcs.OfA(batch.armA);
}

template <bool kRound, int N>
void Solve(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    ChangeVelocities<N>(batch, states, [&](Twist<Real>& a, Twist<Real>& b) FULCRUM_FORCE_INLINE_LAMBDA {
        Aim(batch, a, b, settings);
        const Vec3<Real> residual = MotionAt<Real>(a, b, batch.armA, batch.armB) + batch.aim;
        Change<kRound>(batch, batch.armA, batch.armB, Vec3<Real>(-(batch.mass * residual)), a, b);
    });
}

// Adds the impulse to those of the bodies, with its work for the velocities a and b (WarmStart.h).
template <int N>
FULCRUM_FORCE_INLINE void AddTo(BallBatch<N>& batch, const Twist<Wide<N>>& a, const Twist<Wide<N>>& b,
                                WarmStart* starts, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    if (settings.continues) batch.earlier += batch.impulse;
    Aim(batch, a, b, settings);
    Vec3<Real> speed = batch.aim;
    if ((batch.kinematicA | batch.kinematicB) != 0) {
        Twist<Real> ofA, ofB;
        AddKinematicMotion<N>(ofA, a, batch.kinematicA, 1);
        AddKinematicMotion<N>(ofB, b, batch.kinematicB, 1);
        speed += MotionAt<Real>(ofA, ofB, batch.armA, batch.armB);
    }
    const Twist<Real> onA{-batch.impulse, Cross<Real>(batch.impulse, batch.armA)},
        onB{batch.impulse, Cross<Real>(batch.armB, batch.impulse)};
    AddWarmStart<N>(starts, batch.bodyA, batch.bodyB, batch.count, batch.fixedA, batch.fixedB, onA, onB,
                    Vec2<Real>(Dot<Real>(batch.impulse, speed), Real(0.0f)));
}

// Sets the joints up at the displaced poses and corrects these.
template <bool kRound, int N>
void Correct(BallBatch<N>& batch, const SolverBodies& bodies, WarmStart* starts, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    Motion<N> poseA, poseB;
    poseA.template Gather<BodyRow::Displacement>(batch.bodyA, bodies.states);
    poseB.template Gather<BodyRow::Displacement>(batch.bodyB, bodies.states);
    BallPlace<Real> place = Displaced(batch, bodies.states, poseA, poseB, settings);
    MoveArmsToImpulsePoint(batch, place);
    if (!kRound && batch.turning) GatherMasses<kRound>(batch, bodies.masses);
    batch.armA = place.armA;
    batch.armB = place.armB;
    batch.mass = MassAt<kRound>(batch, place.armA, place.armB);
    const Real part = PartCorrected<N>(batch.high, settings);
    Vec3<Real> wanted;
    for (int k = 0; k < 3; ++k) wanted[k] = Corrected<Real>(place.offset[k], part, settings);
    const Vec3<Real> impulse = -(batch.mass * wanted);
    Twist<Real> a, b;
    AddImpulse<kRound>(batch, batch.armA, batch.armB, impulse, a, b);
    MoveBodies<N>(batch, bodies.states, poseA, poseB, a, b);
    if (!starts) return;
    const Velocities<N> v(batch, bodies.states);
    AddTo(batch, v.a, v.b, starts, settings);
}

}  // namespace

template <int N>
void PrepareJoints(BallBatch<N>& batch, const JointRecord* records, const ConstSolverBodies& bodies,
                   const JointSolveSettings& settings, JointFindings& findings) {
    using Real = Wide<N>;
    Real anchors[8], impulses[8];
    GatherRecordRow<N>(batch.joint, records, JointRecord::kAnchors, anchors);
    GatherImpulses<N>(batch.joint, records, impulses);
    BallPlace<Real> place;
    const auto armAt = [&](const uint32_t(&body)[N], const Vec3<Real>& anchor) {
        return WithinReach<Real>(Rotate<Real>(GatherRotation<N>(body, bodies.poses), anchor));
    };
    place.armA = batch.startArmA = armAt(batch.bodyA, VectorAt<JointRecord::kAnchorA>(anchors));
    place.armB = batch.startArmB = armAt(batch.bodyB, VectorAt<JointRecord::kAnchorB>(anchors));
    place.offset = batch.startOffset =
        WithinReach<Real>(GatherOffset<N>(batch.bodyA, batch.bodyB, bodies.poses) + place.armB - place.armA);
    MoveArmsToImpulsePoint(batch, place);
    batch.armA = place.armA;
    batch.armB = place.armB;
    batch.earlier = Zero<Real>();
    if (batch.round) {
        GatherMasses<true>(batch, bodies.masses);
        batch.mass = MassAt<true>(batch, place.armA, place.armB);
    } else {
        GatherMasses<false>(batch, bodies.masses);
        batch.mass = MassAt<false>(batch, place.armA, place.armB);
    }
    findings.turning |= batch.turning;
    const auto moves = batch.mass.xx + batch.mass.yy + batch.mass.zz > Real(0.0f);
    batch.impulse =
        ZeroUnless<Real>(moves, Vec3<Real>(VectorAt<JointRecord::kForce>(impulses) * Real(settings.impulseScale)));
    NoteLargest<N>(batch.joint, batch.count, Dot<Real>(place.offset, place.offset), findings.linearError,
                   findings.linearJoint);
}

template <int N>
void AddWarmStart(BallBatch<N>& batch, BodyState* states, WarmStart* starts, const JointSolveSettings& settings) {
    const Velocities<N> v(batch, states);
    AddTo(batch, v.a, v.b, starts, settings);
}

template <int N>
void ScaleImpulses(BallBatch<N>& batch, const WarmStart* starts) {
    batch.impulse = batch.impulse * GatherScale<N>(starts, batch.bodyA, batch.bodyB, batch.fixedA);
}

template <int N>
void SolveJointVelocities(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    if (batch.round) Solve<true>(batch, states, settings);
    else Solve<false>(batch, states, settings);
}

template <int N>
void CorrectJoints(BallBatch<N>& batch, const SolverBodies& bodies, WarmStart* starts,
                   const JointSolveSettings& settings) {
    if (batch.round) Correct<true>(batch, bodies, starts, settings);
    else Correct<false>(batch, bodies, starts, settings);
}

template <int N>
void StoreJoints(const BallBatch<N>& batch, JointRecord* records, float dt, float impulseScale) {
    using Real = Wide<N>;
    const Real none(0.0f);
    const auto write = [&](int row, const Vec3<Real>& v) {
        Real values[8] = {none, none, none, none, none, none, none, none};
        SetVectorAt<JointRecord::kForce>(values, v);
        ScatterRecordRow<N>(batch.joint, batch.count, records, row, values);
    };
    write(JointRecord::kOwn, Vec3<Real>(batch.impulse * Real(1.0f / impulseScale)));
    // Only the lock acts.
    const Vec3<Real> force = (batch.impulse + batch.earlier) * Real(1.0f / dt);
    write(JointRecord::kLocks, force);
    write(JointRecord::kTotal, force);
}

#define FULCRUM_INSTANTIATE(lanes)                                                                              \
    template void PrepareJoints(BallBatch<lanes>&, const JointRecord*, const ConstSolverBodies&,                \
                                const JointSolveSettings&, JointFindings&);                                     \
    template void AddWarmStart(BallBatch<lanes>&, BodyState*, WarmStart*, const JointSolveSettings&);           \
    template void ScaleImpulses(BallBatch<lanes>&, const WarmStart*);                                           \
    template void SolveJointVelocities(BallBatch<lanes>&, BodyState*, const JointSolveSettings&);               \
    template void CorrectJoints(BallBatch<lanes>&, const SolverBodies&, WarmStart*, const JointSolveSettings&); \
    template void StoreJoints(const BallBatch<lanes>&, JointRecord*, float, float);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
