// Shared by the contact kernels: reading and writing the twists of a batch, and the twist at the manifold's center.
#pragma once

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Contacts/ContactBatch.h>

namespace fulcrum::contacts {

template <class Real>
FULCRUM_FORCE_INLINE Real InverseOrZero(const Real& x) {
    return Select(x > Real(0.0f), Real(1.0f) / Max(x, Real(1e-30f)), Real(0.0f));
}

// Fraction of the smaller inner radius up to which overlaps have the full softness (inverseSoftDepth).
inline constexpr float kSoftFraction = 0.25f;

// The separation, over the depth of inverseSoftDepth, at which LimitDepth stops a row. start: that of the start of the
// step.
template <class Real>
FULCRUM_FORCE_INLINE Real DepthLimitOf(const Real& start) {
    return Min(Real(-kMostDepth / kSoftFraction), start - Real(kMostDeepening / kSoftFraction));
}
inline constexpr float kLeastDeepening = kDepthTolerance / kSoftFraction;  // likewise, beyond the limit

// The two bodies' twists in lanes; whole rows, so that the scatter preserves their spare floats.
template <int N, bool kFixedB>
struct Twists {
    using Real = Wide<N>;
    float* rowsA[N];
    float* rowsB[N];
    Real a[8], b[8];
};

// Reads velocities only.
template <int N, bool kFixedB>
void GatherVelocities(const ContactBatch<N, kFixedB>& batch, const BodyState* states, Twists<N, kFixedB>& twists) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = states[batch.bodyA[i]].VelocityRow();
    GatherRows<N>(rows, twists.a);
    if constexpr (!kFixedB) {
        for (int i = 0; i < N; ++i) rows[i] = states[batch.bodyB[i]].VelocityRow();
        GatherRows<N>(rows, twists.b);
    }
}

// m/s2, by gravity and forces.
template <int N>
Vec3<Wide<N>> GatherAcceleration(const uint32_t (&bodies)[N], const BodyPose* poses) {
    alignas(64) float accelerations[3][N];
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < 3; ++k) accelerations[k][i] = poses[bodies[i]].acceleration[k];
    return Vec3<Wide<N>>(Wide<N>::Load(accelerations[0]), Wide<N>::Load(accelerations[1]),
                         Wide<N>::Load(accelerations[2]));
}

template <BodyRow kRow, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void Gather(const ContactBatch<N, kFixedB>& batch, BodyState* states, Twists<N, kFixedB>& twists) {
    for (int i = 0; i < N; ++i) twists.rowsA[i] = RowOf<kRow>(states[batch.bodyA[i]]);
    GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(twists.rowsA), twists.a);
    if constexpr (!kFixedB) {
        for (int i = 0; i < N; ++i) twists.rowsB[i] = RowOf<kRow>(states[batch.bodyB[i]]);
        GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(twists.rowsB), twists.b);
    }
}

template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void Scatter(const ContactBatch<N, kFixedB>& batch, const Twists<N, kFixedB>& twists) {
    ScatterRows<N>(twists.rowsA, twists.a, batch.count);
    if constexpr (!kFixedB) ScatterRows<N>(twists.rowsB, twists.b, batch.count);
}

template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Linear(const Real (&row)[8]) {
    return Vec3<Real>(row[BodyState::kLinear], row[BodyState::kLinear + 1], row[BodyState::kLinear + 2]);
}
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Angular(const Real (&row)[8]) {
    return Vec3<Real>(row[BodyState::kAngular], row[BodyState::kAngular + 1], row[BodyState::kAngular + 2]);
}

// The mask of lanes in which the bit of ContactBatch::locks is set.
template <int N>
WideMask<N> LockedLanes(const uint8_t (&locks)[N], int bit) {
    return LanesWhere<N>([&](int i) { return (locks[i] >> bit & 1) != 0; });
}
// The components of a vector along the free translations of body A (side 0) or B (side 1).
template <int N, bool kFixedB>
[[gnu::noinline]] Vec3<Wide<N>> AlongFreeAxes(const ContactBatch<N, kFixedB>& batch, int side, Vec3<Wide<N>> v) {
    const Wide<N> zero(0.0f);
    for (int k = 0; k < 3; ++k) {
        const int bit = 3 * side + k;
        if (!(batch.locksOfSome >> bit & 1)) continue;
        // Most often all bodies have the same locks.
        v[k] = batch.locksOfAll >> bit & 1 ? zero : Select(LockedLanes<N>(batch.locks, bit), zero, v[k]);
    }
    return v;
}

// Adds sign * M^-1 (F, r x F + T) to a row. along: the force along the body's free translations.
template <class Real>
FULCRUM_FORCE_INLINE void ApplyWrench(Real (&row)[8], const UniformInverseMass<Real>& inverse, const Vec3<Real>& arm,
                                      const Vec3<Real>& along, const Vec3<Real>& force, const Vec3<Real>& torque,
                                      Real sign) {
    const Vec3<Real> dv = along * (inverse.mass * sign);
    const Vec3<Real> dw = inverse.inertia * Vec3<Real>((Cross<Real>(arm, force) + torque) * sign);
    row[BodyState::kLinear] += dv.x();
    row[BodyState::kLinear + 1] += dv.y();
    row[BodyState::kLinear + 2] += dv.z();
    row[BodyState::kAngular] += dw.x();
    row[BodyState::kAngular + 1] += dw.y();
    row[BodyState::kAngular + 2] += dw.z();
}

// The relative twist at c, of the velocities or of the displacements, `elapsed` seconds after the start of the step.
template <BodyRow kRow, int N, bool kFixedB>
FULCRUM_FORCE_INLINE Twist<Wide<N>> RelativeTwist(const ContactBatch<N, kFixedB>& batch,
                                                  const Twists<N, kFixedB>& twists, float elapsed) {
    using Real = Wide<N>;
    Twist<Real> relative;
    const Vec3<Real> atA = Linear(twists.a) + Cross<Real>(Angular(twists.a), batch.armA);
    if constexpr (kFixedB) {
        const auto& side = batch.sideB;
        const Real t(elapsed);
        if constexpr (kRow == BodyRow::Velocity) {
            relative.linear = side.velocity.linear + side.acceleration * t - atA;
            relative.angular = side.velocity.angular - Angular(twists.a);
        } else {
            relative.linear = (side.velocity.linear + side.acceleration * Real(0.5f * elapsed)) * t - atA;
            relative.angular = side.velocity.angular * t - Angular(twists.a);
        }
    } else {
        relative.linear = Linear(twists.b) + Cross<Real>(Angular(twists.b), batch.sideB.arm) - atA;
        relative.angular = Angular(twists.b) - Angular(twists.a);
    }
    return relative;
}

// Applies the wrench of the impulses: `force` = n sum + t1 f1 + t2 f2 at c, and the torque about c (N s, N m s).
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void ApplyToBoth(const ContactBatch<N, kFixedB>& batch, Twists<N, kFixedB>& twists,
                                      const Vec3<Wide<N>>& force, const Vec3<Wide<N>>& torque) {
    using Real = Wide<N>;
    Vec3<Real> alongA = force;
    if (batch.isGuided) [[unlikely]]
        alongA = AlongFreeAxes(batch, 0, force);
    ApplyWrench<Real>(twists.a, batch.inverseA, batch.armA, alongA, force, torque, Real(-1.0f));
    if constexpr (!kFixedB) {
        Vec3<Real> alongB = force;
        if (batch.isGuided) [[unlikely]]
            alongB = AlongFreeAxes(batch, 1, force);
        ApplyWrench<Real>(twists.b, batch.sideB.inverse, batch.sideB.arm, alongB, force, torque, Real(1.0f));
    }
}

template <int N>
FULCRUM_FORCE_INLINE void GatherRecordRow(const uint32_t (&index)[N], const ContactRecord* records, int row,
                                          Wide<N> (&out)[8]) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = records[index[i]].Row(row);
    GatherRows<N>(rows, out);
}

// Surface velocity of B relative to A at c, in addition to the motion of the bodies.
template <class Real>
struct SurfaceMotion {
    Real v1, v2;  // m/s along t1 and t2
    Real spin;    // rad/s about n
};
template <int N, bool kFixedB>
SurfaceMotion<Wide<N>> GatherSurfaceMotion(const ContactBatch<N, kFixedB>& batch, const SurfaceVelocity* surfaces) {
    using Real = Wide<N>;
    Vec3<Real> linear = Vec3<Real>::Zero(), angular = linear;
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < 3; ++k) {
            linear[k].Set(i, surfaces[batch.contact[i]].linear[k]);
            angular[k].Set(i, surfaces[batch.contact[i]].angular[k]);
        }
    const auto finite = (Dot<Real>(linear, linear) + Dot<Real>(angular, angular)) * Real(0.0f) == Real(0.0f);
    const auto along = [&](const Vec3<Real>& v, const Vec3<Real>& axis) {
        return Select(finite, Dot<Real>(v, axis), Real(0.0f));
    };
    return {along(linear, batch.tangent1), along(linear, batch.tangent2), along(angular, batch.normal)};
}

// Torque about c of normal impulses: sum of (a t1 + b t2) x n l, with sums over a l and b l.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE Vec3<Wide<N>> NormalTorque(const ContactBatch<N, kFixedB>& batch, Wide<N> sumA, Wide<N> sumB) {
    return batch.tangent1 * sumB - batch.tangent2 * sumA;
}

// Sums over the normal rows: of the impulses l, and of a l and b l.
template <class Real>
struct NormalImpulses {
    Real sum{0.0f}, sumA{0.0f}, sumB{0.0f};

    template <class Row>
    FULCRUM_FORCE_INLINE void Add(const Row& row, Real impulse) {
        sum += impulse;
        sumA += row.a * impulse;
        sumB += row.b * impulse;
    }
};

// The components of the twist that the normal rows depend on: J v of a point is linear + b angular1 - a angular2.
template <class Real>
struct NormalMotion {
    Real linear, angular1, angular2;
};
// J v of a point's row.
template <class Row, class Real>
FULCRUM_FORCE_INLINE Real MotionOf(const Row& row, const NormalMotion<Real>& motion) {
    return motion.linear + row.b * motion.angular1 - row.a * motion.angular2;
}
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE NormalMotion<Wide<N>> NormalMotionOf(const ContactBatch<N, kFixedB>& batch,
                                                          const Twist<Wide<N>>& relative) {
    using Real = Wide<N>;
    return {Dot<Real>(relative.linear, batch.normal), Dot<Real>(relative.angular, batch.tangent1),
            Dot<Real>(relative.angular, batch.tangent2)};
}

// Work of the normal impulses on both bodies, J, if the motion is a displacement, or power, W, if it is a velocity.
template <class Real>
FULCRUM_FORCE_INLINE Real WorkOf(const NormalImpulses<Real>& impulses, const NormalMotion<Real>& motion) {
    return impulses.sum * motion.linear + impulses.sumB * motion.angular1 - impulses.sumA * motion.angular2;
}

// The accumulated impulses of the normal rows.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE NormalImpulses<Wide<N>> TotalOf(const ContactBatch<N, kFixedB>& batch) {
    NormalImpulses<Wide<N>> total;
    for (int i = 0; i < batch.pointCount; ++i) total.Add(batch.rows[i], batch.rows[i].impulse);
    return total;
}

// Force and torque about c of all accumulated impulses, N s and N m s.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE Twist<Wide<N>> TotalWrench(const ContactBatch<N, kFixedB>& batch) {
    const NormalImpulses<Wide<N>> normal = TotalOf(batch);
    const auto* f = batch.frictionImpulse;
    return {batch.normal * normal.sum + batch.tangent1 * f[0] + batch.tangent2 * f[1],
            NormalTorque(batch, normal.sumA, normal.sumB) + batch.normal * f[2]};
}

// Index into `response` of the pair i < j.
constexpr int PairIndex(int i, int j) { return i == 0 ? j - 1 : i + j; }

// One Gauss-Seidel sweep over the normal rows, of a position iteration. missing: m, by which each point is to move
// apart; less what the rows before it move, after the sweep.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE NormalImpulses<Wide<N>> SweepMissing(const ContactBatch<N, kFixedB>& batch, Wide<N>* missing) {
    using Real = Wide<N>;
    NormalImpulses<Real> impulses;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        const Real lambda = Max(row.inverseResponse * missing[i], Real(0.0f));
        for (int j = i + 1; j < batch.pointCount; ++j) missing[j] -= batch.response[PairIndex(i, j)] * lambda;
        impulses.Add(row, lambda);
    }
    return impulses;
}

}  // namespace fulcrum::contacts
