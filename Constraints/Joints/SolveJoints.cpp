#include <Fulcrum/Constraints/Joints/JointKernels.h>

namespace fulcrum {

namespace {

using namespace joints;

// The first rows of a vector of three, as many as a lock has.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Narrowed(const Vec3<Real>& v, const Vec3<Real>&) {
    return v;
}
template <class Real>
FULCRUM_FORCE_INLINE Vec2<Real> Narrowed(const Vec3<Real>& v, const Vec2<Real>&) {
    return {v.x(), v.y()};
}

// Adds the impulses of the finished substep to the sums of the step.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SumImpulses(JointBatch<N>& batch) {
    using Real = Wide<N>;
    const auto add = [&](Vec3<Real>& sum, const auto& part, const Vec3<Real>& reaction) {
        const auto lambda = part.GetTotalLambda();
        for (int k = 0; k < lambda.size(); ++k) sum[k] += lambda[k];
        if (batch.rowCount > 0)
            for (int k = 0; k < lambda.size(); ++k) sum[k] += reaction[k];
    };
    if constexpr (kLinear != LinearLock::None)
        add(batch.earlierLinear, LinearPart<kLinear>(batch), batch.reactionLinear);
    if constexpr (kAngular != AngularLock::None)
        add(batch.earlierAngular, AngularPart<kAngular>(batch), batch.reactionAngular);
    Real impulses[JointRowList::kMaxRows];
    RowImpulses(batch, impulses);
    for (uint32_t i = 0; i < batch.rowCount; ++i) batch.rows[i].earlier += impulses[i];
}

// Total impulses of the locks, with their reaction to the rows.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE LockImpulses<Wide<N>> TotalImpulses(const JointBatch<N>& batch) {
    using Real = Wide<N>;
    LockImpulses<Real> total;
    if constexpr (kLinear != LinearLock::None)
        total.linear = Widened(LinearPart<kLinear>(batch).GetTotalLambda(), Real(0.0f));
    if constexpr (kAngular != AngularLock::None)
        total.angular = Widened(AngularPart<kAngular>(batch).GetTotalLambda(), Real(0.0f));
    if (batch.rowCount == 0) return total;
    if constexpr (kLinear != LinearLock::None) AddReaction(total.linear, batch.reactionLinear);
    if constexpr (kAngular != AngularLock::None) AddReaction(total.angular, batch.reactionAngular);
    return total;
}

// The impulses on both bodies and their work (WarmStart.h). a, b: velocities of those bodies that are not dynamic, else
// zero.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE Vec2<Wide<N>> FindWarmStart(const JointBatch<N>& batch, const Twist<Wide<N>>& a,
                                                 const Twist<Wide<N>>& b, Twist<Wide<N>>& onA, Twist<Wide<N>>& onB) {
    using Real = Wide<N>;
    Vec2<Real> work(Real(0.0f), Real(0.0f));
    Sym3<Real> one;
    one.xx = one.yy = one.zz = Real(1.0f);
    const InverseMass<Real> unit(Real(1.0f), one);
    const LockImpulses<Real> total = TotalImpulses<kLinear, kAngular>(batch);
    const auto add = [&](const auto& part, const Vec3<Real>& impulse) FULCRUM_FORCE_INLINE_LAMBDA {
        const auto lambda = Narrowed(impulse, part.GetTotalLambda());
        part.AddImpulse(onA, onB, unit, unit, lambda, Real(0.0f) < Real(1.0f));
        const auto speed = part.RelativeMotion(a, b) + part.GetBias();
        for (int k = 0; k < lambda.size(); ++k) work[0] += lambda[k] * speed[k];
    };
    if constexpr (kAngular != AngularLock::None) add(AngularPart<kAngular>(batch), total.angular);
    if constexpr (kLinear != LinearLock::None) add(LinearPart<kLinear>(batch), total.linear);
    Real impulses[JointRowList::kMaxRows];
    RowImpulses(batch, impulses);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const auto& part = batch.rows[i].part;
        const RowJacobian<Real>& j = part.GetJacobian();
        AddResponse<>(ResponseOf<>(j, unit, unit), impulses[i], onA, onB);
        work += part.WarmStartWork(impulses[i], RelativeMotion<>(j, a, b));
    }
    return work;
}

template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SolveRow(JointBatch<N>& batch, JointRows<N>& row, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    const Real before = row.part.GetTotalLambda();
    row.part.SolveVelocity(a, b, row.lowest, row.highest);
    const Real delta = row.part.GetTotalLambda() - before;
    if constexpr (kLinear != LinearLock::None) batch.reactionLinear += row.lockLinear * delta;
    if constexpr (kAngular != AngularLock::None) batch.reactionAngular += row.lockAngular * delta;
}

// Both locks as one block.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SolveBoth(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    auto& linearPart = LinearPart<kLinear>(batch);
    auto& angularPart = AngularPart<kAngular>(batch);
    const LockImpulses<Real> motion = LockMotion<kLinear, kAngular>(batch, a, b);
    const LockImpulses<Real> x =
        SolveBlock<kLinear, kAngular>(batch, motion.linear + Widened(linearPart.GetBias(), Real(0.0f)),
                                      motion.angular + Widened(angularPart.GetBias(), Real(0.0f)));
    const auto apply = [&](auto& part, const Vec3<Real>& wide) FULCRUM_FORCE_INLINE_LAMBDA {
        part.AddLambda(a, b, batch.massA, batch.massB, -Narrowed(wide, part.GetTotalLambda()), Real(0.0f) < Real(1.0f));
    };
    apply(angularPart, x.angular);
    apply(linearPart, x.linear);
}

// Locks come before rows: a row's response includes the reaction of the locks, which thus stay satisfied. A row before
// them would react to motion that the locks have yet to stop: of a rod that is held at one end its impulse would be up
// to four times too large, and iterations of limits between contacts would diverge.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SolveAll(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    if constexpr (!kCoupled<kLinear, kAngular>) {
        if constexpr (kAngular != AngularLock::None)
            AngularPart<kAngular>(batch).SolveVelocity(a, b, batch.massA, batch.massB);
        if constexpr (kLinear != LinearLock::None)
            LinearPart<kLinear>(batch).SolveVelocity(a, b, batch.massA, batch.massB);
    } else {
        SolveBoth<kLinear, kAngular>(batch, a, b);
    }
    for (uint32_t i = 0; i < batch.rowCount; ++i) SolveRow<kLinear, kAngular>(batch, batch.rows[i], a, b);
}

template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE JointPlace<Wide<N>> Displace(const JointBatch<N>& batch, const Twist<Wide<N>>& a,
                                                  const Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    JointPlace<Real> place;
    const Quat<Real> turnA = RotationOf<Real>(a.angular), turnB = RotationOf<Real>(b.angular);
    if (kLinear != LinearLock::None || batch.radial) {
        place.armA = Rotate<Real>(turnA, batch.startArmA);
        place.armB = Rotate<Real>(turnB, batch.startArmB);
        place.offset =
            batch.startOffset + (b.linear - a.linear) + (place.armB - batch.startArmB) - (place.armA - batch.startArmA);
    }
    if constexpr (kLinear == LinearLock::Line) {
        place.line = Rotate<Real>(turnA, batch.startLine);
        place.lineNormal = batch.startLineNormal;
    }
    if constexpr (kAngular == AngularLock::All)
        place.rotationError = RotationError<Real>(turnA, turnB, batch.inverseInitial);
    if constexpr (kAngular == AngularLock::Axis) {
        place.axisA = Rotate<Real>(turnA, batch.startAxisA);
        place.axisB = Rotate<Real>(turnB, batch.startAxisB);
        place.normal = batch.startNormal;
    }
    return place;
}

// Updates the parts and the rows' errors to the displaced poses.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::noinline]] JointErrors<Wide<N>> Follow(JointBatch<N>& batch, const SolverBodies& bodies, const Motion<N>& poseA,
                                              const Motion<N>& poseB, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    Twist<Real> a = poseA.Get(), b = poseB.Get();
    if ((batch.kinematicA | batch.kinematicB) != 0) {
        const Velocities<N> v(batch, bodies.states);
        AddKinematicMotion<N>(a, v.a, batch.kinematicA, settings.elapsed);
        AddKinematicMotion<N>(b, v.b, batch.kinematicB, settings.elapsed);
    }
    if (batch.turning) GatherMasses(batch, bodies.masses);
    const JointPlace<Real> place = Displace<kLinear, kAngular>(batch, a, b);
    const JointErrors<Real> errors = SetUpParts<kLinear, kAngular>(batch, place);
    SetUpCoupling<kLinear, kAngular>(batch);
    if (batch.rowCount > 0) MoveRows(batch, a, b);
    if (batch.radial) RotateRadialRows(batch, place);
    if (batch.rowCount > 0) SetUpRows<kLinear, kAngular>(batch);
    SetRowBias(batch, bodies.states);
    return errors;
}

// Calls change(linear lock, angular lock, velocities of A, of B) for the batch and scatters the velocities back.
template <int N, class Batch, class F>
FULCRUM_FORCE_INLINE void ChangeLocked(Batch& batch, BodyState* states, F&& change) {
    ChangeVelocities<N>(batch, states, [&](auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        WithLocks(batch.linear, batch.angular,
                  [&](auto linear, auto angular) FULCRUM_FORCE_INLINE_LAMBDA { change(linear, angular, a, b); });
    });
}

// AddWarmStart for these locks.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void AddTo(JointBatch<N>& batch, BodyState* states, WarmStart* starts,
                                const JointSolveSettings& settings) {
    using Real = Wide<N>;
    if (settings.continues) SumImpulses<kLinear, kAngular>(batch);
    const Velocities<N> v(batch, states);
    AimAtEnd<kLinear, kAngular>(batch, v.a, v.b, settings);
    Twist<Real> ofA, ofB, onA, onB;
    AddKinematicMotion<N>(ofA, v.a, batch.kinematicA, 1);
    AddKinematicMotion<N>(ofB, v.b, batch.kinematicB, 1);
    const Vec2<Real> work = FindWarmStart<kLinear, kAngular>(batch, ofA, ofB, onA, onB);
    if (batch.overridesMass) [[unlikely]] {
        // As if with the masses of the bodies: an override scales what an impulse changes.
        onA.linear = onA.linear * batch.massScaleA;
        onA.angular = onA.angular * batch.inertiaScaleA;
        onB.linear = onB.linear * batch.massScaleB;
        onB.angular = onB.angular * batch.inertiaScaleB;
    }
    AddWarmStart<N>(starts, batch.bodyA, batch.bodyB, batch.count, batch.fixedA, batch.fixedB, onA, onB, work);
}

}  // namespace

template <int N>
void AddWarmStart(JointBatch<N>& batch, BodyState* states, WarmStart* starts, const JointSolveSettings& settings) {
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) FULCRUM_FORCE_INLINE_LAMBDA {
        AddTo<linear, angular>(batch, states, starts, settings);
    });
}

template <int N>
void ScaleImpulses(JointBatch<N>& batch, const WarmStart* starts) {
    using Real = Wide<N>;
    const Real scale = GatherScale<N>(starts, batch.bodyA, batch.bodyB, batch.fixedA);
    const auto scaled = [&](auto& part) { part.SetTotalLambda(part.GetTotalLambda() * scale); };
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) FULCRUM_FORCE_INLINE_LAMBDA {
        if constexpr (linear != LinearLock::None) scaled(LinearPart<linear>(batch));
        if constexpr (angular != AngularLock::None) scaled(AngularPart<angular>(batch));
    });
    if (batch.rowCount == 0) return;
    for (uint32_t i = 0; i < batch.rowCount; ++i) scaled(batch.rows[i].part);
    batch.reactionLinear = batch.reactionLinear * scale;
    batch.reactionAngular = batch.reactionAngular * scale;
}

template <int N>
void SolveJointVelocities(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    ChangeLocked<N>(batch, states, [&](auto linear, auto angular, auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        AimAtEnd<linear, angular>(batch, a, b, settings);
        SolveAll<linear, angular>(batch, a, b);
    });
}

template <int N>
void AimJoints(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    const Velocities<N> v(batch, states);
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) FULCRUM_FORCE_INLINE_LAMBDA {
        AimAtEnd<linear, angular>(batch, v.a, v.b, settings);
    });
}

// The least part of the error of a limit that a position iteration corrects. More than of a lock: only what passes a
// limit is wrong, and bodies that slide along it pass it in every step.
constexpr float kLimitPart = 0.5f;

template <int N>
void CorrectJoints(JointBatch<N>& batch, const SolverBodies& bodies, WarmStart* starts,
                   const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f), part = PartCorrected<N>(batch.high, settings);
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
        Motion<N> poseA, poseB;
        poseA.template Gather<BodyRow::Displacement>(batch.bodyA, bodies.states);
        poseB.template Gather<BodyRow::Displacement>(batch.bodyB, bodies.states);
        const JointErrors<Real> errors = Follow<linear, angular>(batch, bodies, poseA, poseB, settings);
        Twist<Real> a, b;
        const auto correct = [&](auto& lock, const auto& error, Vec3<Real>& wide) {
            auto wanted = error;
            for (int k = 0; k < wanted.size(); ++k) wanted[k] = Corrected<Real>(error[k], part, settings);
            if (settings.leavesLocks) {
                lock.SetBias(wanted, {});
                for (int k = 0; k < wanted.size(); ++k) wanted[k] = zero;
            }
            if constexpr (kCoupled<linear, angular>) wide = Widened(wanted, zero);
            else lock.SolvePosition(a, b, batch.massA, batch.massB, wanted, one);
        };
        LockImpulses<Real> wanted;
        if constexpr (angular == AngularLock::All) correct(batch.rotation, errors.rotation, wanted.angular);
        if constexpr (angular == AngularLock::Axis) correct(batch.hinge, errors.hinge, wanted.angular);
        if constexpr (linear == LinearLock::Point) correct(batch.point, errors.point, wanted.linear);
        if constexpr (linear == LinearLock::Line) correct(batch.line, errors.line, wanted.linear);
        if constexpr (kCoupled<linear, angular>) {
            LockImpulses<Real> x = SolveBlock<linear, angular>(batch, wanted.linear, wanted.angular);
            x.linear = -x.linear;
            x.angular = -x.angular;
            AddLockMotion<linear, angular>(batch, a, b, x);
        }
        // Rows after the locks, as in velocity iterations. Limits and rows that are locks are corrected, less what has
        // moved already; not springs, which are forces.
        for (uint32_t i = 0; i < batch.rowCount; ++i) {
            const JointRows<N>& row = batch.rows[i];
            const auto corrects = row.IsCorrected() & (row.error <= row.openAbove);
            const auto isLimit = row.openAbove <= zero;
            const Real left = Corrected<Real>(row.error, Select(isLimit, Max(part, Real(kLimitPart)), part), settings) +
                              RelativeMotion<>(row.part.GetJacobian(), a, b);
            const Real toCorrect = Select(isLimit, Real(Min(left, zero)), left);
            row.part.SolvePosition(a, b, Select(corrects, toCorrect, zero), one);
        }
        MoveBodies<N>(batch, bodies.states, poseA, poseB, a, b);
        if (starts) AddTo<linear, angular>(batch, bodies.states, starts, settings);
    });
}

#define FULCRUM_INSTANTIATE(lanes)                                                                     \
    template void AddWarmStart(JointBatch<lanes>&, BodyState*, WarmStart*, const JointSolveSettings&); \
    template void ScaleImpulses(JointBatch<lanes>&, const WarmStart*);                                 \
    template void AimJoints(JointBatch<lanes>&, BodyState*, const JointSolveSettings&);                \
    template void SolveJointVelocities(JointBatch<lanes>&, BodyState*, const JointSolveSettings&);     \
    template void CorrectJoints(JointBatch<lanes>&, const SolverBodies&, WarmStart*, const JointSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
