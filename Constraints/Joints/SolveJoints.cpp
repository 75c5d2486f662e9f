#include <Fulcrum/Constraints/Joints/JointKernels.h>

namespace fulcrum {

namespace {

using namespace joints;

// Adds the total impulses of the locks to the velocities, times `sign`.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void AddLockImpulses(const JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b,
                                          float sign) {
    using Real = Wide<N>;
    const auto add = [&](const auto& part, const Vec3<Real>& reaction) {
        auto lambda = part.GetTotalLambda();
        if (batch.rowCount > 0) AddReaction<decltype(lambda), Real>(lambda, reaction);
        for (int k = 0; k < lambda.size(); ++k) lambda[k] = lambda[k] * Real(sign);
        part.AddImpulse(a, b, batch.massA, batch.massB, lambda, Real(0.0f) < Real(1.0f));
    };
    if constexpr (kAngular == AngularLock::All) add(batch.rotation, batch.reactionAngular);
    if constexpr (kAngular == AngularLock::Axis) add(batch.hinge, batch.reactionAngular);
    if constexpr (kLinear == LinearLock::Point) add(batch.point, batch.reactionLinear);
    if constexpr (kLinear == LinearLock::Line) add(batch.line, batch.reactionLinear);
}

// The same for the rows' impulses, without the reaction of the locks, and only in lanes whose direction or mass changes
// within the step, independently of other lanes.
template <int N>
FULCRUM_FORCE_INLINE void AddTurningRows(const JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b, float sign) {
    using Real = Wide<N>;
    Real impulses[JointRowList::kMaxRows];
    RowImpulses(batch, impulses);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const JointRows<N>& row = batch.rows[i];
        const Real turns = Max(Max(row.radial, row.turnsWithA), batch.turns) * Real(sign);
        AddResponse<>(ResponseOf<>(row.part.GetJacobian(), batch.massA, batch.massB), Real(impulses[i] * turns), a, b);
    }
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

// Ends a substep: computes the change of the impulses due to the rotation of the parts.
template <LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void Turn(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    SumImpulses<kLinear, kAngular>(batch);
    a.angular += batch.turnedA.angular;
    b.angular += batch.turnedB.angular;
    if constexpr (kLinear != LinearLock::Point) {
        a.linear += batch.turnedA.linear;
        b.linear += batch.turnedB.linear;
    }
}

// The same, applied at once, for these lanes.
template <LinearLock kLinear, int N>
[[gnu::noinline, gnu::cold]] void TurnAtOnce(JointBatch<N>& batch, const WideMask<N>& lanes, Twist<Wide<N>>& a,
                                             Twist<Wide<N>>& b) {
    AddAtOnce<N>(lanes, batch.turnedA.angular, a.angular);
    AddAtOnce<N>(lanes, batch.turnedB.angular, b.angular);
    if constexpr (kLinear != LinearLock::Point) {
        AddAtOnce<N>(lanes, batch.turnedA.linear, a.linear);
        AddAtOnce<N>(lanes, batch.turnedB.linear, b.linear);
    }
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

// The first rows of a vector of three, as many as a lock has.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Narrowed(const Vec3<Real>& v, const Vec3<Real>&) {
    return v;
}
template <class Real>
FULCRUM_FORCE_INLINE Vec2<Real> Narrowed(const Vec3<Real>& v, const Vec2<Real>&) {
    return {v.x(), v.y()};
}

// Both locks as one block. A relax iteration is hard and without bias; the parts are set up that way then.
template <bool kRelax, LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SolveBoth(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    using Real = Wide<N>;
    auto& linearPart = LinearPart<kLinear>(batch);
    auto& angularPart = AngularPart<kAngular>(batch);
    LockImpulses<Real> error = LockMotion<kLinear, kAngular>(batch, a, b);
    if constexpr (!kRelax) {
        error.linear += Widened(linearPart.GetBias(), Real(0.0f));
        error.angular += Widened(angularPart.GetBias(), Real(0.0f));
    }
    const LockImpulses<Real> x = SolveBlock<kLinear, kAngular>(batch, error.linear, error.angular);
    const auto apply = [&](auto& part, const Vec3<Real>& wide) FULCRUM_FORCE_INLINE_LAMBDA {
        auto delta = Narrowed(wide, part.GetTotalLambda());
        if constexpr (kRelax) {
            delta = -delta;
        } else {
            const RowSoftness<Real>& softness = part.GetSoftness();
            delta = SoftDelta(delta * softness.massScale, part.GetTotalLambda(), softness.impulseScale);
        }
        part.AddLambda(a, b, batch.massA, batch.massB, delta, Real(0.0f) < Real(1.0f));
    };
    apply(angularPart, x.angular);
    apply(linearPart, x.linear);
}

// Locks come before rows: a row's response includes the reaction of the locks, which thus stay satisfied. A row before
// them would react to motion that the locks have yet to stop: of a rod that is held at one end its impulse would be up
// to four times too large, and iterations of limits between contacts would diverge.
template <bool kRelax, LinearLock kLinear, AngularLock kAngular, int N>
FULCRUM_FORCE_INLINE void SolveAll(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b) {
    if constexpr (!kCoupled<kLinear, kAngular>) {
        if constexpr (kAngular != AngularLock::None)
            AngularPart<kAngular>(batch).SolveVelocity(a, b, batch.massA, batch.massB);
        if constexpr (kLinear != LinearLock::None)
            LinearPart<kLinear>(batch).SolveVelocity(a, b, batch.massA, batch.massB);
    } else {
        SolveBoth<kRelax, kLinear, kAngular>(batch, a, b);
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

// Updates the parts and the rows' errors to the displaced poses; the change due to the rotation of the locks' impulses
// is left for the next substep.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::noinline]] JointErrors<Wide<N>> Follow(JointBatch<N>& batch, const SolverBodies& bodies,
                                              const Twist<Wide<N>>& velocityA, const Twist<Wide<N>>& velocityB,
                                              const JointSolveSettings& settings) {
    using Real = Wide<N>;
    Motion<N> motionA, motionB;
    motionA.template Gather<BodyRow::Displacement>(batch.bodyA, bodies.states);
    motionB.template Gather<BodyRow::Displacement>(batch.bodyB, bodies.states);
    Twist<Real> a = motionA.Get(), b = motionB.Get();
    AddKinematicMotion<N>(a, velocityA, batch.kinematicA, settings.elapsed);
    AddKinematicMotion<N>(b, velocityB, batch.kinematicB, settings.elapsed);
    constexpr bool kLocks = kLinear != LinearLock::None || kAngular != AngularLock::None;
    constexpr bool kTurns = kLinear != LinearLock::None || kAngular == AngularLock::Axis;
    Twist<Real> turnedA, turnedB;
    if (!settings.firstPass) {
        turnedA = batch.turnedA;
        turnedB = batch.turnedB;
    }
    const bool turnRows = batch.rowCount > 0 && (batch.radial || batch.rowsTurnWithA || batch.turning);
    const bool turns = kTurns || turnRows || (kLocks && (batch.rowCount > 0 || batch.turning));
    if (turns) {
        AddLockImpulses<kLinear, kAngular>(batch, turnedA, turnedB, -1.0f);
        if (turnRows) AddTurningRows(batch, turnedA, turnedB, -1.0f);
    }
    if (batch.turning) GatherMasses(batch, bodies.masses);
    const JointPlace<Real> place = Displace<kLinear, kAngular>(batch, a, b);
    const JointErrors<Real> errors = SetUpParts<kLinear, kAngular>(batch, place);
    SetUpCoupling<kLinear, kAngular>(batch);
    if (batch.rowCount > 0) MoveRows(batch, a, b);
    if (batch.radial)
        for (uint32_t i = 0; i < batch.rowCount; ++i) RotateRadialRow(batch, batch.rows[i], place);
    if (batch.rowCount > 0) SetUpRows<kLinear, kAngular>(batch);
    if (turns) {
        AddLockImpulses<kLinear, kAngular>(batch, turnedA, turnedB, 1.0f);
        if (turnRows) AddTurningRows(batch, turnedA, turnedB, 1.0f);
    }
    batch.turnedA.angular = turnedA.angular;
    batch.turnedB.angular = turnedB.angular;
    if constexpr (kLinear != LinearLock::Point) {
        batch.turnedA.linear = turnedA.linear;
        batch.turnedB.linear = turnedB.linear;
    }
    return errors;
}

// Corrects the errors of rows that are not pushed (CorrectsPose), as fast as they would be.
template <int N>
[[gnu::noinline]] void CorrectPivots(const JointBatch<N>& batch, BodyState* states,
                                     const JointSolveSettings& settings) {
    using Real = Wide<N>;
    constexpr float kFastest = 2;  // rad/s: what one joint of a mechanism is turned by, the others must follow
    const Real zero(0.0f), h(settings.substepDt);
    Twist<Real> a, b;
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const JointRows<N>& row = batch.rows[i];
        const auto corrects = CorrectsPose(row) & (row.error <= row.openAbove);
        const Real most = Min(row.mostPush, Real(kFastest)), error = Clamp(row.pushRate * row.error, -most, most) * h;
        // What the rows before it have moved already.
        const Real moved = RelativeMotion<>(row.part.GetJacobian(), a, b);
        const Real left = Select(row.error < zero, Min(error + moved, zero), error + moved);
        row.part.SolvePosition(a, b, Select(corrects, left, zero), Real(1.0f));
    }
    MoveBodies<N>(batch, states, a, b);
}

// Calls change(linear lock, angular lock, velocities of A, of B) for the batch and scatters the velocities back.
template <int N, class Batch, class F>
FULCRUM_FORCE_INLINE void ChangeLocked(Batch& batch, BodyState* states, F&& change) {
    ChangeVelocities<N>(batch, states, [&](auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        WithLocks(batch.linear, batch.angular,
                  [&](auto linear, auto angular) FULCRUM_FORCE_INLINE_LAMBDA { change(linear, angular, a, b); });
    });
}

}  // namespace

template <int N>
void WarmStartJoints(const JointBatch<N>& batch, BodyState* states) {
    ChangeLocked<N>(batch, states, [&](auto linear, auto angular, auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        for (uint32_t i = 0; i < batch.rowCount; ++i) batch.rows[i].part.WarmStart(a, b);
        if constexpr (angular != AngularLock::None)
            AngularPart<angular>(batch).WarmStart(a, b, batch.massA, batch.massB);
        if constexpr (linear != LinearLock::None) LinearPart<linear>(batch).WarmStart(a, b, batch.massA, batch.massB);
    });
}

template <int N>
void RotateJointImpulses(JointBatch<N>& batch, BodyState* states) {
    ChangeLocked<N>(batch, states, [&](auto linear, auto angular, auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        Turn<linear, angular>(batch, a, b);
    });
}

template <int N>
void SolveJointVelocities(JointBatch<N>& batch, BodyState* states, const JointSolveSettings& settings) {
    ChangeLocked<N>(batch, states, [&](auto linear, auto angular, auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        if (settings.continues) Turn<linear, angular>(batch, a, b);
        SolveAll<false, linear, angular>(batch, a, b);
    });
}

template <int N>
void RelaxJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    ChangeLocked<N>(batch, bodies.states, [&](auto linear, auto angular, auto& a, auto& b) FULCRUM_FORCE_INLINE_LAMBDA {
        const auto isPushed = IsPushedFast<linear, angular>(batch);
        const JointErrors<Wide<N>> errors = Follow<linear, angular>(batch, bodies, a, b, settings);
        if (isPushed.Any()) [[unlikely]]
            TurnAtOnce<linear>(batch, isPushed, a, b);
        if (batch.pivots && settings.firstPass && settings.pushes) CorrectPivots(batch, bodies.states, settings);
        SetRowRelax(batch);
        SolveAll<true, linear, angular>(batch, a, b);
        Soften<linear, angular>(batch, errors, settings);
    });
}

template <int N>
void UpdateJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
        const Velocities<N> v(batch, bodies.states);
        Soften<linear, angular>(batch, Follow<linear, angular>(batch, bodies, v.a, v.b, settings), settings);
    });
}

template <int N>
void CorrectJoints(JointBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f), part(settings.baumgarte), most(settings.maxPushSpeed * settings.substepDt);
    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
        const Velocities<N> v(batch, bodies.states);
        const JointErrors<Real> errors = Follow<linear, angular>(batch, bodies, v.a, v.b, settings);
        Twist<Real> a, b;
        const auto isNear = batch.isFar <= Real(0.5f);
        const auto correction = [&](const Real& error) {
            return Select(isNear, Clamp(Real(error * part), -most, most), zero);
        };
        for (uint32_t i = 0; i < batch.rowCount; ++i) {
            const JointRows<N>& row = batch.rows[i];
            // Corrects locks and limits, for rows that couple two motions scaled by the ratio; not springs, which are
            // forces.
            const auto corrects =
                (row.mostPush > zero) & (row.mostPush < Real(JointRow::kUnlimited)) & (row.error <= row.openAbove);
            row.part.SolvePosition(a, b, Select(corrects, correction(row.error), zero), one);
        }
        const auto correct = [&](auto& lock, const auto& error, Vec3<Real>& wide) {
            auto wanted = error;
            for (int k = 0; k < wanted.size(); ++k) wanted[k] = correction(error[k]);
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
        MoveBodies<N>(batch, bodies.states, a, b);
    });
}

#define FULCRUM_INSTANTIATE(lanes)                                                                  \
    template void WarmStartJoints(const JointBatch<lanes>&, BodyState*);                            \
    template void RotateJointImpulses(JointBatch<lanes>&, BodyState*);                              \
    template void SolveJointVelocities(JointBatch<lanes>&, BodyState*, const JointSolveSettings&);  \
    template void RelaxJoints(JointBatch<lanes>&, const SolverBodies&, const JointSolveSettings&);  \
    template void UpdateJoints(JointBatch<lanes>&, const SolverBodies&, const JointSolveSettings&); \
    template void CorrectJoints(JointBatch<lanes>&, const SolverBodies&, const JointSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
