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

// Moves the arms to the point at which impulses act; for joints that are far apart, as if the anchors coincided.
template <int N>
FULCRUM_FORCE_INLINE void MoveArmsToImpulsePoint(const BallBatch<N>& batch, BallPlace<Wide<N>>& place) {
    using Real = Wide<N>;
    const Real share = ImpulsePointFraction<N>(batch.fixedA, batch.fixedB);
    const Vec3<Real> between = batch.far ? ZeroUnless<Real>(batch.isFar <= Real(0.5f), place.offset) : place.offset;
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

template <int N>
FULCRUM_FORCE_INLINE void SetPush(BallBatch<N>& batch, const Vec3<Wide<N>>& offset,
                                  const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real rate(settings.pushes ? settings.pushRate : 0.0f), most(settings.maxPushSpeed);
    for (int k = 0; k < 3; ++k) batch.push[k] = Clamp<Real>(offset[k] * rate, -most, most);
    if (!batch.far) return;
    const auto isFar = batch.isFar > Real(0.5f);
    for (int k = 0; k < 3; ++k) {
        batch.push[k] = Select(isFar, Real(0.0f), batch.push[k]);
        batch.pull[k] = Select(isFar, PullSpeed<Real>(offset[k], settings), Real(0.0f));
    }
}

// Finds the joints that are far apart and are pulled, see PullJoints.
template <int N>
FULCRUM_FORCE_INLINE void FindFar(BallBatch<N>& batch, const Vec3<Wide<N>>& offset, const Wide<N>& wasPulled,
                                  const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real most(settings.maxPushSpeed), rate(settings.pushRate);
    const Real error = Max(Max(Abs(offset.x()), Abs(offset.y())), Abs(offset.z())) * (rate / most);
    const auto isDistant = error > Real(FarPush(settings));
    batch.pushed =
        IsPushedFar<Real>(error * (most / rate), Real(0.0f), batch.startArmA, batch.startArmB, settings).ToBits() &
        LanesOf(batch);
    const Real near = SecondsNear(wasPulled, isDistant, settings);
    const auto mayPull =
        MayPull<Real>(error * (most / rate), batch.startArmA, batch.startArmB, wasPulled, batch.secondsOfTeleport);
    const auto isFar = (error > FarPush<Real>(wasPulled, settings)) & mayPull & (near <= Real(LongestNear(settings)));
    batch.far = isFar.Any();
    batch.isFar = Select(isFar, Real(kWasFar) + near, Real(0.0f));
    batch.isDistant = Select(isDistant, Real(1.0f), Real(0.0f));
}

template <int N>
FULCRUM_FORCE_INLINE void ForgetWhereNewlyFar(BallBatch<N>& batch, const Wide<N>& wasPulled) {
    using Real = Wide<N>;
    if (!batch.far) return;
    // No warm start: the last impulses were computed with other lever arms.
    const auto isNew = (batch.isFar > Real(0.5f)) & (wasPulled < Real(kFollowed));
    for (int k = 0; k < 3; ++k) batch.impulse[k] = Select(isNew, Real(0.0f), Real(batch.impulse[k]));
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
FULCRUM_FORCE_INLINE BallPlace<Wide<N>> Displaced(const BallBatch<N>& batch, BodyState* states,
                                                  const Twist<Wide<N>>& velocityA, const Twist<Wide<N>>& velocityB,
                                                  const JointSolveSettings& settings) {
    using Real = Wide<N>;
    Motion<N> poseA, poseB;
    poseA.template Gather<BodyRow::Displacement>(batch.bodyA, states);
    poseB.template Gather<BodyRow::Displacement>(batch.bodyB, states);
    Twist<Real> a = poseA.Get(), b = poseB.Get();
    Quat<Real> turnA = TurnOf(poseA), turnB = TurnOf(poseB);
    if ((batch.kinematicA | batch.kinematicB) != 0) {
        AddKinematicMotion<N>(a, velocityA, batch.kinematicA, settings.elapsed);
        AddKinematicMotion<N>(b, velocityB, batch.kinematicB, settings.elapsed);
        turnA = RotationOf<Real>(a.angular);
        turnB = RotationOf<Real>(b.angular);
    }
    BallPlace<Real> place{Rotate<Real>(turnA, batch.startArmA), Rotate<Real>(turnB, batch.startArmB), {}};
    place.offset =
        batch.startOffset + (b.linear - a.linear) + (place.armB - batch.startArmB) - (place.armA - batch.startArmA);
    return place;
}

// Sets the joints up at the displaced poses; the change due to the rotation of the impulse is left for the next
// substep. Returns the offsets between the anchors.
template <bool kRound, int N>
FULCRUM_FORCE_INLINE Vec3<Wide<N>> Follow(BallBatch<N>& batch, const SolverBodies& bodies,
                                          const Twist<Wide<N>>& velocityA, const Twist<Wide<N>>& velocityB,
                                          const JointSolveSettings& settings) {
    using Real = Wide<N>;
    BallPlace<Real> place = Displaced(batch, bodies.states, velocityA, velocityB, settings);
    MoveArmsToImpulsePoint(batch, place);
    Vec3<Real> turnedA, turnedB;
    const auto turnAt = [&](const Vec3<Real>& armA, const Vec3<Real>& armB) {
        turnedA = -Times<Real>(InertiaOfA<kRound>(batch), Cross<Real>(armA, batch.impulse));
        turnedB = Times<Real>(InertiaOfB<kRound>(batch), Cross<Real>(armB, batch.impulse));
    };
    if constexpr (kRound) {
        turnAt(place.armA - batch.armA, place.armB - batch.armB);
    } else {
        turnAt(batch.armA, batch.armB);
        const Vec3<Real> beforeA = turnedA, beforeB = turnedB;
        if (batch.turning) GatherMasses<kRound>(batch, bodies.masses);
        turnAt(place.armA, place.armB);
        turnedA -= beforeA;
        turnedB -= beforeB;
    }
    if (!settings.firstPass) {
        turnedA += batch.turnedA;
        turnedB += batch.turnedB;
    }
    batch.turnedA = turnedA;
    batch.turnedB = turnedB;
    batch.armA = place.armA;
    batch.armB = place.armB;
    batch.mass = MassAt<kRound>(batch, place.armA, place.armB);
    SetPush(batch, place.offset, settings);
    return place.offset;
}

// See kFastPush.
template <int N>
[[gnu::noinline, gnu::cold]] void TurnAtOnce(BallBatch<N>& batch, const WideMask<N>& lanes, Twist<Wide<N>>& a,
                                             Twist<Wide<N>>& b) {
    AddAtOnce<N>(lanes, batch.turnedA, a.angular);
    AddAtOnce<N>(lanes, batch.turnedB, b.angular);
}

template <bool kRound, int N>
void Solve(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    ChangeVelocities<N>(batch, states, [&](Twist<Real>& a, Twist<Real>& b) FULCRUM_FORCE_INLINE_LAMBDA {
        if (settings.continues) {
            batch.earlier += batch.impulse;
            a.angular += batch.turnedA;
            b.angular += batch.turnedB;
        }
        const Vec3<Real> residual = MotionAt<Real>(a, b, batch.armA, batch.armB) + batch.push;
        const Vec3<Real> hard = batch.mass * residual;
        Change<kRound>(batch, batch.armA, batch.armB,
                       SoftDelta(Vec3<Real>(hard * Real(settings.softness.massScale)), batch.impulse,
                                 Real(settings.softness.impulseScale)),
                       a, b);
    });
}

template <bool kRound, int N>
void Relax(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    ChangeVelocities<N>(batch, bodies.states, [&](Twist<Real>& a, Twist<Real>& b) FULCRUM_FORCE_INLINE_LAMBDA {
        const auto isPushed =
            IsPushedFast(batch, Real(Max(Max(Abs(batch.push.x()), Abs(batch.push.y())), Abs(batch.push.z()))));
        Follow<kRound>(batch, bodies, a, b, settings);
        if (isPushed.Any()) [[unlikely]]
            TurnAtOnce(batch, isPushed, a, b);
        const Vec3<Real> hard = batch.mass * MotionAt<Real>(a, b, batch.armA, batch.armB);
        Change<kRound>(batch, batch.armA, batch.armB, Vec3<Real>(-hard), a, b);
    });
}

template <bool kRound, int N>
void Correct(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Velocities<N> v(batch, bodies.states);
    const Vec3<Real> offset = Follow<kRound>(batch, bodies, v.a, v.b, settings);
    const Real part(settings.baumgarte), most(settings.maxPushSpeed * settings.substepDt);
    Vec3<Real> wanted;
    for (int k = 0; k < 3; ++k) wanted[k] = Clamp<Real>(offset[k] * part, -most, most);
    const Vec3<Real> impulse = ZeroUnless<Real>(batch.isFar <= Real(0.5f), Vec3<Real>(-(batch.mass * wanted)));
    Twist<Real> a, b;
    AddImpulse<kRound>(batch, batch.armA, batch.armB, impulse, a, b);
    MoveBodies<N>(batch, bodies.states, a, b);
}

// As PullFar and HoldNear in PullJoints.cpp.
template <bool kRound, int N>
void Pull(BallBatch<N>& batch, BodyState* pseudo, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    MarkNearFixed(batch, pseudo);
    ChangeVelocities<N>(batch, pseudo, [&](Twist<Real>& a, Twist<Real>& b) {
        batch.follows = Follows<Real>(batch.follows, a, b, settings);
        if (batch.far) {
            const Real sum = batch.inverseMassA + batch.inverseMassB;
            const Vec3<Real> impulse =
                (b.linear - a.linear + batch.pull) * (-batch.isDistant / Select(sum > Real(0.0f), sum, Real(1.0f)));
            a.linear -= impulse * batch.inverseMassA;
            b.linear += impulse * batch.inverseMassB;
        }
        Vec3<Real> residual = MotionAt<Real>(a, b, batch.armA, batch.armB);
        if (batch.far)
            for (int k = 0; k < 3; ++k)
                residual[k] = Select(batch.isFar > Real(0.5f), residual[k] + batch.pull[k], residual[k]);
        AddImpulse<kRound>(batch, batch.armA, batch.armB,
                           ZeroUnless<Real>(batch.isDistant <= Real(0.5f), Vec3<Real>(-(batch.mass * residual))), a, b);
    });
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
    batch.secondsOfTeleport = SecondsLeft<Real>(impulses[JointRecord::kSecondsOfTeleport], settings);
    FindFar(batch, place.offset, impulses[JointRecord::kWasPulled], settings);
    findings.far |= batch.far;
    findings.pushed |= batch.pushed != 0;
    MoveArmsToImpulsePoint(batch, place);
    batch.armA = place.armA;
    batch.armB = place.armB;
    batch.earlier = Zero<Real>();
    batch.follows = Real(0.0f);
    if (batch.round) {
        GatherMasses<true>(batch, bodies.masses);
        batch.mass = MassAt<true>(batch, place.armA, place.armB);
    } else {
        GatherMasses<false>(batch, bodies.masses);
        batch.mass = MassAt<false>(batch, place.armA, place.armB);
    }
    const auto moves = batch.mass.xx + batch.mass.yy + batch.mass.zz > Real(0.0f);
    batch.impulse =
        ZeroUnless<Real>(moves, Vec3<Real>(VectorAt<JointRecord::kForce>(impulses) * Real(settings.impulseScale)));
    ForgetWhereNewlyFar(batch, impulses[JointRecord::kWasPulled]);
    SetPush(batch, place.offset, settings);
    NoteLargest<N>(batch.joint, batch.count, Dot<Real>(place.offset, place.offset), findings.linearError,
                   findings.linearJoint);
}

template <int N>
void WarmStartJoints(const BallBatch<N>& batch, BodyState* states) {
    ChangeVelocities<N>(batch, states, [&](auto& a, auto& b) {
        if (batch.round) AddImpulse<true>(batch, batch.armA, batch.armB, batch.impulse, a, b);
        else AddImpulse<false>(batch, batch.armA, batch.armB, batch.impulse, a, b);
    });
}

template <int N>
void SolveJointVelocities(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    if (batch.round) Solve<true>(batch, states, settings);
    else Solve<false>(batch, states, settings);
}

template <int N>
void RelaxJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    if (batch.round) Relax<true>(batch, bodies, settings);
    else Relax<false>(batch, bodies, settings);
}

template <int N>
void UpdateJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    const Velocities<N> v(batch, bodies.states);
    if (batch.round) Follow<true>(batch, bodies, v.a, v.b, settings);
    else Follow<false>(batch, bodies, v.a, v.b, settings);
}

template <int N>
void CorrectJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    if (batch.round) Correct<true>(batch, bodies, settings);
    else Correct<false>(batch, bodies, settings);
}

template <int N>
void PullJoints(BallBatch<N>& batch, BodyState* pseudo, const JointSolveSettings& settings) {
    if (batch.round) Pull<true>(batch, pseudo, settings);
    else Pull<false>(batch, pseudo, settings);
}

template <int N>
void StoreJoints(const BallBatch<N>& batch, JointRecord* records, float dt, float impulseScale) {
    using Real = Wide<N>;
    const Real none(0.0f);
    const auto write = [&](int row, const Vec3<Real>& v, const Real& wasPulled, const Real& secondsOfTeleport) {
        Real values[8] = {none, none, none, none, none, none, none, none};
        SetVectorAt<JointRecord::kForce>(values, v);
        values[JointRecord::kWasPulled] = wasPulled;
        values[JointRecord::kSecondsOfTeleport] = secondsOfTeleport;
        ScatterRecordRow<N>(batch.joint, batch.count, records, row, values);
    };
    write(JointRecord::kOwn, Vec3<Real>(batch.impulse * Real(1.0f / impulseScale)), Max(batch.isFar, batch.follows),
          batch.secondsOfTeleport);
    // Only the lock acts.
    const Vec3<Real> force = (batch.impulse + batch.earlier) * Real(1.0f / dt);
    write(JointRecord::kLocks, force, none, none);
    write(JointRecord::kTotal, force, none, none);
}

#define FULCRUM_INSTANTIATE(lanes)                                                                  \
    template void PrepareJoints(BallBatch<lanes>&, const JointRecord*, const ConstSolverBodies&,    \
                                const JointSolveSettings&, JointFindings&);                         \
    template void WarmStartJoints(const BallBatch<lanes>&, BodyState*);                             \
    template void SolveJointVelocities(BallBatch<lanes>&, BodyState*, const JointSolveSettings&);   \
    template void RelaxJoints(BallBatch<lanes>&, const SolverBodies&, const JointSolveSettings&);   \
    template void UpdateJoints(BallBatch<lanes>&, const SolverBodies&, const JointSolveSettings&);  \
    template void CorrectJoints(BallBatch<lanes>&, const SolverBodies&, const JointSolveSettings&); \
    template void PullJoints(BallBatch<lanes>&, BodyState*, const JointSolveSettings&);             \
    template void StoreJoints(const BallBatch<lanes>&, JointRecord*, float, float);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
