// Gather and scatter for the joint kernels: motions and masses of a batch's bodies, rows of the records. Free
// functions, no state.
#pragma once

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>

#include <cmath>
#include <limits>

namespace fulcrum::joints {

// Velocities or displacements of one body per lane.
template <int N>
struct Motion {
    using Real = Wide<N>;
    float* rows[N];
    Real row[8];

    template <BodyRow kRow>
    FULCRUM_FORCE_INLINE void Gather(const uint32_t (&bodies)[N], BodyState* states) {
        for (int i = 0; i < N; ++i) rows[i] = RowOf<kRow>(states[bodies[i]]);
        GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(rows), row);
    }
    FULCRUM_FORCE_INLINE Twist<Real> Get() const {
        return {VectorAt<BodyState::kLinear>(row), VectorAt<BodyState::kAngular>(row)};
    }
    // Lanes of static and kinematic bodies are not written.
    FULCRUM_FORCE_INLINE void Scatter(const Twist<Real>& motion, int count, uint32_t fixed) {
        Set(motion);
        Scatter(count, fixed);
    }
    FULCRUM_FORCE_INLINE void Set(const Twist<Real>& motion) {
        SetVectorAt<BodyState::kLinear>(row, motion.linear);
        SetVectorAt<BodyState::kAngular>(row, motion.angular);
    }
    FULCRUM_FORCE_INLINE void Scatter(int count, uint32_t fixed) {
        alignas(32) float nowhere[8];
        if (fixed != 0)
            for (int i = 0; i < N; ++i)
                if (fixed >> i & 1u) rows[i] = nowhere;
        ScatterRows<N>(rows, row, count);
    }
};

// Velocities of A and of B.
template <int N>
struct Velocities {
    Twist<Wide<N>> a, b;

    template <class Batch>
    FULCRUM_FORCE_INLINE Velocities(const Batch& batch, const BodyState* states) {
        a = Of(batch.bodyA, states);
        b = Of(batch.bodyB, states);
    }

private:
    FULCRUM_FORCE_INLINE static Twist<Wide<N>> Of(const uint32_t (&bodies)[N], const BodyState* states) {
        const float* rows[N];
        Wide<N> row[8];
        for (int i = 0; i < N; ++i) rows[i] = states[bodies[i]].VelocityRow();
        GatherRows<N>(rows, row);
        return {VectorAt<BodyState::kLinear>(row), VectorAt<BodyState::kAngular>(row)};
    }
};

// Adds to the displacements of the bodies, NaN as zero, so that one bad joint cannot spread it to bodies. Where
// inertias turn with them, so do angular velocities, which keeps their kinetic energy. poseA, poseB: as gathered.
template <int N, class Batch>
FULCRUM_FORCE_INLINE void MoveBodies(const Batch& batch, BodyState* states, Motion<N>& poseA, Motion<N>& poseB,
                                     const Twist<Wide<N>>& byA, const Twist<Wide<N>>& byB) {
    using Real = Wide<N>;
    const auto move = [&](const uint32_t(&body)[N], Motion<N>& pose, const Twist<Real>& wanted, uint32_t fixed) {
        const auto isKnown = Dot<Real>(wanted.linear, wanted.linear) + Dot<Real>(wanted.angular, wanted.angular) <
                             Real(std::numeric_limits<float>::infinity());
        const Twist<Real> by{ZeroUnless<Real>(isKnown, wanted.linear), ZeroUnless<Real>(isKnown, wanted.angular)};
        const Twist<Real> from = pose.Get();
        pose.Set({from.linear + by.linear,
                  TurnedSlightly<Real>(from.angular,
                                       Vec2<Real>(pose.row[BodyState::kHalfTurn], pose.row[BodyState::kHalfTurn + 1]),
                                       by.angular)});
        SetHalfTurn<Real>(pose.row);
        pose.Scatter(batch.count, fixed);
        if (!batch.turning) return;
        Motion<N> motion;
        motion.template Gather<BodyRow::Velocity>(body, states);
        const Twist<Real> velocity = motion.Get();
        const Vec2<Real> half = HalfTurnOf<Real>(by.angular);
        const Vec3<Real> turn = by.angular * (half.x() * batch.turns),
                         across = Cross<Real>(turn, velocity.angular) * Real(2.0f);
        motion.Set({velocity.linear, velocity.angular + across * half.y() + Cross<Real>(turn, across)});
        motion.Scatter(batch.count, fixed);
    };
    move(batch.bodyA, poseA, byA, batch.fixedA);
    move(batch.bodyB, poseB, byB, batch.fixedB);
}

// Calls change(velocities of A, of B) and scatters them back.
template <int N, class Batch, class F>
FULCRUM_FORCE_INLINE void ChangeVelocities(const Batch& batch, BodyState* states, F&& change) {
    Motion<N> motionA, motionB;
    motionA.template Gather<BodyRow::Velocity>(batch.bodyA, states);
    motionB.template Gather<BodyRow::Velocity>(batch.bodyB, states);
    Twist<Wide<N>> a = motionA.Get(), b = motionB.Get();
    change(a, b);
    motionA.Scatter(a, batch.count, batch.fixedA);
    motionB.Scatter(b, batch.count, batch.fixedB);
}

// The bodies' masses for these joints, mass overrides applied. Returns the mask of lanes in which an inertia rotates.
template <int N>
FULCRUM_FORCE_INLINE auto GatherMasses(JointBatch<N>& batch, const BodyMass* masses) {
    const Wide<N> flagsA = GatherMass<N>(batch.bodyA, masses, batch.massA),
                  flagsB = GatherMass<N>(batch.bodyB, masses, batch.massB);
    const auto turns = TurningLanes<N>(flagsA) | TurningLanes<N>(flagsB);
    if (batch.overridesMass) {
        ScaleMass(batch.massA, batch.massScaleA, batch.inertiaScaleA);
        ScaleMass(batch.massB, batch.massScaleB, batch.inertiaScaleB);
    }
    return turns;
}

template <int N>
FULCRUM_FORCE_INLINE void GatherRecordRow(const uint32_t (&joints)[N], const JointRecord* records, int row,
                                          Wide<N> (&out)[8]) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = records[joints[i]].Row(row);
    GatherRows<N>(rows, out);
}

// Clamps arms and offsets of anchors along each axis: longer ones do not increase the correction speed, and the inertia
// at the end of a longer arm may overflow a float.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> WithinReach(const Vec3<Real>& v) {
    const Real farthest(1e6f);
    Vec3<Real> result;
    for (int k = 0; k < 3; ++k) result[k] = Clamp(Real(v[k]), -farthest, farthest);
    return result;
}

// The locks' impulses of the last substep; values that are not finite as zero.
template <int N>
FULCRUM_FORCE_INLINE void GatherImpulses(const uint32_t (&joints)[N], const JointRecord* records, Wide<N> (&out)[8]) {
    GatherRecordRow<N>(joints, records, JointRecord::kOwn, out);
    for (Wide<N>& x : out) x = Select(Abs(x) < Wide<N>(JointRow::kUnlimited), x, Wide<N>(0.0f));
}

// Writes a row of the first `count` records; values that are not finite as zero.
template <int N>
FULCRUM_FORCE_INLINE void ScatterRecordRow(const uint32_t (&joints)[N], int count, JointRecord* records, int row,
                                           const Wide<N> (&values)[8]) {
    using Real = Wide<N>;
    float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = records[joints[i]].Row(row);
    Real out[8];
    for (int k = 0; k < 8; ++k) out[k] = Select(Abs(values[k]) < Real(JointRow::kUnlimited), values[k], Real(0.0f));
    ScatterRows<N>(rows, out, count);
}

}  // namespace fulcrum::joints
