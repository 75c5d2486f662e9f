// Bodies' numbers in lanes, for the kernels of contacts and joints: gathered by the indices of a batch. Called where
// batches are prepared and solved; free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>

namespace fulcrum {

// Which row of a body's solver state.
enum class BodyRow { Velocity, Displacement };

template <BodyRow kRow>
FULCRUM_FORCE_INLINE float* RowOf(BodyState& state) {
    return kRow == BodyRow::Velocity ? state.VelocityRow() : state.PoseRow();
}

// Returns the lanes whose inertia turns.
template <int N>
FULCRUM_FORCE_INLINE auto GatherMass(const uint32_t (&index)[N], const BodyMass* masses, InverseMass<Wide<N>>& out) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = masses[index[i]].Row();
    Wide<N> r[8];
    GatherRows<N>(rows, r);
    out.inertia = {r[0], r[1], r[2], r[3], r[4], r[5]};
    out.mass = r[6];
    return r[7] > Wide<N>(0.0f);
}

template <int N>
FULCRUM_FORCE_INLINE Quat<Wide<N>> GatherRotation(const uint32_t (&index)[N], const BodyPose* poses) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = poses[index[i]].rotation;
    Wide<N> r[8];
    GatherRows<N>(rows, r);
    return {r[0], r[1], r[2], r[3]};
}

// From A's center of mass to B's, m.
template <int N>
FULCRUM_FORCE_INLINE Vec3<Wide<N>> GatherOffset(const uint32_t (&bodyA)[N], const uint32_t (&bodyB)[N],
                                                const BodyPose* poses) {
    alignas(64) float offsets[3][N];
    for (int i = 0; i < N; ++i)
        for (int k = 0; k < 3; ++k)
            offsets[k][i] = static_cast<float>(poses[bodyB[i]].position[k] - poses[bodyA[i]].position[k]);
    using Real = Wide<N>;
    return Vec3<Real>(Real::Load(offsets[0]), Real::Load(offsets[1]), Real::Load(offsets[2]));
}

// A unit vector perpendicular to the unit vector n (Duff et al., JCGT 2017).
template <class Real>
inline Vec3<Real> PerpendicularTo(const Vec3<Real>& n) {
    const Real sign = Select(n.z() < Real(0.0f), Real(-1.0f), Real(1.0f));
    const Real a = Real(-1.0f) / (sign + n.z());
    return Vec3<Real>(Real(1.0f) + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x());
}

}  // namespace fulcrum
