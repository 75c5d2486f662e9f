// Joints that are far apart are pulled together by pseudo-velocities (split impulses), which change poses but never
// velocities. All joints and contacts of the bodies are solved for them, too, so that connected bodies move along and
// contacts are respected. Ball joints: SolveBalls.cpp.
#include <Fulcrum/Constraints/Joints/JointKernels.h>

namespace fulcrum {

namespace {

using namespace joints;

// Adds an impulse to the row's pseudo-impulse of this substep, clamped to the row's limits. Returns the change.
template <class Rows, class Real>
FULCRUM_FORCE_INLINE Real AddWithinLimits(Rows& row, const Real& impulse) {
    const Real total = Clamp(Real(row.pulled + impulse), row.lowest, row.highest), added = total - row.pulled;
    row.pulled = total;
    return added;
}

// Pull speed of a row. For rows that couple two motions by a ratio it scales with the ratio.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> PullSpeedOf(const JointRows<N>& row, const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const RowJacobian<Real>& j = row.part.GetJacobian();
    const Real squaredA = Dot<Real>(j.a.linear, j.a.linear), squaredB = Dot<Real>(j.b.linear, j.b.linear);
    const auto moves = (Max(squaredA, squaredB) > Real(0.0f)) & (row.about <= Real(0.0f));
    const Real ratio = Select(moves, Sqrt(Max(squaredA, squaredB)), Real(1.0f));
    return PullSpeed<Real>(row.error / ratio, settings) * ratio;
}

// Pulls the distant lanes. This need not conserve momentum: translation acts at the centers of mass, and rotation is
// about them, since a lever arm as long as the gap would make the effective mass tiny.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::noinline]] void PullDistant(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b,
                                   const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f);
    const Vec3<Real>&massA = batch.massA.mass, &massB = batch.massB.mass;
    const auto isDistant = batch.isDistant > Real(0.5f);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        const RowJacobian<Real>& j = row.part.GetJacobian();
        const Vec3<Real> moveA = j.a.linear.cwiseProduct(massA), moveB = j.b.linear.cwiseProduct(massB);
        const Real linear = Dot<Real>(j.a.linear, moveA) + Dot<Real>(j.b.linear, moveB);
        const auto moves = (linear > zero) & (row.about <= zero);
        const Vec3<Real> turnA = batch.massA.inertia * j.a.angular, turnB = batch.massB.inertia * j.b.angular;
        const Real angular = Dot<Real>(j.a.angular, turnA) + Dot<Real>(j.b.angular, turnB);
        const Real response = Select(moves, linear, angular);
        const auto acts = isDistant & row.part.IsActive() & (response > zero) & (row.error <= row.openAbove) &
                          (row.mostPush < Real(JointRow::kUnlimited));
        const Real speed = Select(moves, Real(Dot<Real>(j.b.linear, b.linear) - Dot<Real>(j.a.linear, a.linear)),
                                  Real(Dot<Real>(j.b.angular, b.angular) - Dot<Real>(j.a.angular, a.angular)));
        const Real wanted = -(speed + PullSpeedOf(row, settings)) / Select(acts, response, one);
        const Real impulse = AddWithinLimits(row, Select(acts, wanted, zero));
        const Real moving = Select(moves, impulse, zero), turning = Select(moves, zero, impulse);
        a.linear -= moveA * moving;
        b.linear += moveB * moving;
        a.angular -= turnA * turning;
        b.angular += turnB * turning;
    }
    if constexpr (kAngular != AngularLock::None) {
        auto& part = AngularPart<kAngular>(batch);
        auto residual = part.RelativeMotion(a, b);
        for (int k = 0; k < residual.size(); ++k) residual[k] = -(residual[k] + batch.pullAngular[k]) * batch.isDistant;
        part.AddImpulse(a, b, batch.massA, batch.massB, part.GetEffectiveMass() * residual, isDistant);
    }
    if constexpr (kLinear != LinearLock::None) {
        Vec3<Real> residual = b.linear - a.linear;
        if constexpr (kLinear == LinearLock::Line) {
            const auto& frame = batch.line.GetFrame();
            residual = frame.axis1 * (Dot<Real>(frame.axis1, residual) + batch.pullLinear[0]) +
                       frame.axis2 * (Dot<Real>(frame.axis2, residual) + batch.pullLinear[1]);
        } else {
            residual += batch.pullLinear;
        }
        Vec3<Real> impulse;
        for (int k = 0; k < 3; ++k) {
            const Real sum = massA[k] + massB[k];
            impulse[k] = residual[k] * (-batch.isDistant / Select(sum > zero, sum, one));
        }
        a.linear -= impulse.cwiseProduct(massA);
        b.linear += impulse.cwiseProduct(massB);
    }
}

// Locks and limits of the other lanes resist, as in a relax iteration. Lanes that were far apart use the rest of their
// pull as target: if bodies only rotated about their centers, their anchors would move apart, and the bodies would spin
// up. Motors and springs do not act on pseudo-velocities.
template <LinearLock kLinear, AngularLock kAngular, int N>
[[gnu::noinline]] void HoldNear(JointBatch<N>& batch, Twist<Wide<N>>& a, Twist<Wide<N>>& b,
                                const JointSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    const auto isNear = batch.isDistant <= Real(0.5f), isPulled = isNear & (batch.isFar > Real(0.5f));
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& row = batch.rows[i];
        Real speed = Max(row.error, zero) * row.gapRate;
        if (batch.far) speed = Select(isPulled & (row.error <= row.openAbove), PullSpeedOf(row, settings), speed);
        const Real wanted = -row.part.GetEffectiveMass() * (RelativeMotion<>(row.part.GetJacobian(), a, b) + speed);
        const auto acts = isNear & row.part.IsActive() & (row.mostPush < Real(JointRow::kUnlimited));
        const Real impulse = AddWithinLimits(row, Select(acts, wanted, zero));
        AddResponse<>(row.part.GetResponse(), impulse, a, b);
    }
    if constexpr (kLinear != LinearLock::None || kAngular != AngularLock::None) {
        LockImpulses<Real> motion = LockMotion<kLinear, kAngular>(batch, a, b);
        for (int k = 0; batch.far && k < 3; ++k) {
            motion.linear[k] = Select(isPulled, motion.linear[k] + batch.pullLinear[k], motion.linear[k]);
            motion.angular[k] = Select(isPulled, motion.angular[k] + batch.pullAngular[k], motion.angular[k]);
        }
        LockImpulses<Real> impulses = SolveBlock<kLinear, kAngular>(batch, motion.linear, motion.angular);
        for (int k = 0; k < 3; ++k) {
            impulses.linear[k] = Select(isNear, Real(-impulses.linear[k]), zero);
            impulses.angular[k] = Select(isNear, Real(-impulses.angular[k]), zero);
        }
        AddLockMotion<kLinear, kAngular>(batch, a, b, impulses);
    }
}

// Mask of the lanes in which a body has locked translations.
template <int N>
uint32_t LocksTranslation(const JointBatch<N>& batch) {
    using Real = Wide<N>;
    const auto locksOf = [](const Vec3<Real>& mass) {
        return (Min(Min(mass.x(), mass.y()), mass.z()) <= Real(0.0f)).ToBits();
    };
    return (locksOf(batch.massA.mass) & ~batch.fixedA) | (locksOf(batch.massB.mass) & ~batch.fixedB);
}

}  // namespace

template <int N>
void PullJoints(JointBatch<N>& batch, BodyState* pseudo, const JointSolveSettings& settings) {
    if (settings.firstPass)
        for (uint32_t i = 0; i < batch.rowCount; ++i) batch.rows[i].pulled = Wide<N>(0.0f);
    MarkNearFixed(batch, pseudo, LocksTranslation(batch));
    ChangeVelocities<N>(batch, pseudo, [&](auto& a, auto& b) {
        batch.follows = Follows<Wide<N>>(batch.follows, a, b, settings);
        WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
            if (batch.far) PullDistant<linear, angular>(batch, a, b, settings);
            HoldNear<linear, angular>(batch, a, b, settings);
        });
    });
}

#define FULCRUM_INSTANTIATE(lanes) template void PullJoints(JointBatch<lanes>&, BodyState*, const JointSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
