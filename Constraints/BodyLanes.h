// Gathers the data of a batch's bodies into SIMD lanes, and scatters it back, for the kernels of contacts and joints.
// Called where batches are prepared and solved; free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <initializer_list>

namespace fulcrum {

// Which row of a body's solver state.
enum class BodyRow { Velocity, Displacement };

template <BodyRow kRow>
FULCRUM_FORCE_INLINE float* RowOf(BodyState& state) {
    return kRow == BodyRow::Velocity ? state.VelocityRow() : state.PoseRow();
}

// Returns BodyMass::flags.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> GatherMass(const uint32_t (&index)[N], const BodyMass* masses,
                                        UniformInverseMass<Wide<N>>& out) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = masses[index[i]].Row();
    Wide<N> r[8];
    GatherRows<N>(rows, r);
    constexpr int i = BodyMass::kInverseInertia;
    out.inertia = {r[i], r[i + 1], r[i + 2], r[i + 3], r[i + 4], r[i + 5]};
    out.mass = r[BodyMass::kInverseMass];
    return r[BodyMass::kFlags];
}

// Mask of the lanes of a batch that are in use.
template <class Batch>
uint32_t LanesOf(const Batch& batch) {
    return (1u << batch.count) - 1;
}

// Whether a body has a locked translation.
template <int N>
FULCRUM_FORCE_INLINE bool AnyLocked(const Wide<N>& flags) {
    return HorizontalMax(flags) >= float{BodyMass::kLockedX};
}

// The mask of lanes for which is(lane).
template <int N, class Is>
WideMask<N> LanesWhere(const Is& is) {
    Wide<N> lanes(0.0f);
    for (int i = 0; i < N; ++i)
        if (is(i)) lanes.Set(i, 1.0f);
    return lanes > Wide<N>(0.0f);
}

// The mask of lanes with the flag.
template <int N>
[[gnu::noinline, gnu::cold]] WideMask<N> LanesWith(const Wide<N>& flags, int flag) {
    return LanesWhere<N>([&](int i) { return (static_cast<int>(flags[i]) & flag) != 0; });
}

// The mask of lanes whose inertia rotates with the body within the step.
template <int N>
FULCRUM_FORCE_INLINE WideMask<N> TurningLanes(const Wide<N>& flags) {
    if (AnyLocked<N>(flags)) [[unlikely]]
        return LanesWith<N>(flags, BodyMass::kTurns);
    return flags > Wide<N>(0.0f);
}

// The same with an inverse mass for each axis.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> GatherMass(const uint32_t (&index)[N], const BodyMass* masses, InverseMass<Wide<N>>& out) {
    UniformInverseMass<Wide<N>> uniform;
    const Wide<N> flags = GatherMass<N>(index, masses, uniform);
    out = {uniform.mass, uniform.inertia};
    if (AnyLocked<N>(flags)) [[unlikely]]
        for (int k = 0; k < 3; ++k)
            out.mass[k] = Select(LanesWith<N>(flags, BodyMass::kLockedX << k), Wide<N>(0.0f), out.mass[k]);
    return flags;
}

// Applies the scales of a MassOverride.
template <class Mass, class Real>
FULCRUM_FORCE_INLINE void ScaleMass(Mass& inverse, const Real& massScale, const Real& inertiaScale) {
    inverse.mass = inverse.mass * massScale;
    Sym3<Real>& i = inverse.inertia;
    for (Real* x : {&i.xx, &i.yy, &i.zz, &i.xy, &i.xz, &i.yz}) *x = *x * inertiaScale;
}

template <int N>
FULCRUM_FORCE_INLINE Quat<Wide<N>> GatherRotation(const uint32_t (&index)[N], const BodyPose* poses) {
    const float* rows[N];
    for (int i = 0; i < N; ++i) rows[i] = poses[index[i]].Row();
    Wide<N> r[8];
    GatherRows<N>(rows, r);
    return QuaternionAt<BodyPose::kRotation>(r);
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

// The smaller of the two bodies' inner radii, m.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> GatherInnerRadius(const uint32_t (&bodyA)[N], const uint32_t (&bodyB)[N],
                                               const BodyPose* poses) {
    alignas(64) float radii[N];
    for (int i = 0; i < N; ++i) {
        const float a = poses[bodyA[i]].innerRadius, b = poses[bodyB[i]].innerRadius;
        radii[i] = a < b ? a : b;
    }
    return Wide<N>::Load(radii);
}

inline bool Any(bool mask) { return mask; }
template <int N>
FULCRUM_FORCE_INLINE bool Any(WideMask<N> mask) {
    return mask.Any();
}

// sin(a / 2) / a and cos(a / 2) with a = |v|: by the first terms of the Taylor series below one radian, the usual case;
// the next term is below float precision.
template <class Real>
FULCRUM_FORCE_INLINE Vec2<Real> HalfTurnOf(const Vec3<Real>& v) {
    const Real square = Dot<Real>(v, v), one(1.0f);
    const Real scale =
        Real(0.5f) - square * (Real(1.0f / 48) - square * (Real(1.0f / 3840) - square * Real(1.0f / 645120)));
    const Real cosine =
        one - square * (Real(1.0f / 8) -
                        square * (Real(1.0f / 384) - square * (Real(1.0f / 46080) - square * Real(1.0f / 10321920))));
    const auto isFar = square > one;
    if (!Any(isFar)) return Vec2<Real>(scale, cosine);
    const Real angle = Sqrt(square);
    const SineCosine<Real> half = SinCos<Real>(angle * Real(0.5f));
    return Vec2<Real>(Select(isFar, Real(half.sine / angle), scale), Select(isFar, half.cosine, cosine));
}

// The rotation by a vector, rad, nearly unit.
inline Quaternion TurnOf(const Vector3& v) {
    const Vec2<float> half = HalfTurnOf<float>(v);
    return {v.x() * half.x(), v.y() * half.x(), v.z() * half.x(), half.y()};
}

// Rotation vectors of a step up to this length, rad, are composed as rotations; longer ones are added, since the
// composition is singular at a full revolution.
inline constexpr float kFarthestTurn = 5.5f;

// The rotation vector, rad, of the rotation `before`, followed by that of a small turn, to first order in it (inverse
// left Jacobian of the rotation vector). half: HalfTurnOf `before`.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> TurnedSlightly(const Vec3<Real>& before, const Vec2<Real>& half,
                                               const Vec3<Real>& turn) {
    // (1 - (t / 2) cot(t / 2)) / t^2 for an angle t.
    const Real squared = Dot<Real>(before, before), largest(0.1f);
    Real gamma = Real(1.0f / 12) + squared * (Real(1.0f / 720) + squared * Real(1.0f / 30240));
    const Vec3<Real> across = Cross<Real>(turn, before), sum = before + turn;
    if (!Any(squared > largest)) [[likely]]
        return sum + across * Real(0.5f) - Cross<Real>(before, across) * gamma;
    const Real closed = (Real(1.0f) - Real(0.5f) * half.y() / half.x()) / Max(squared, largest);
    gamma = Select(squared > largest, closed, gamma);
    const Vec3<Real> composed = sum + across * Real(0.5f) - Cross<Real>(before, across) * gamma;
    Vec3<Real> result;
    const auto isFar = squared > Real(kFarthestTurn * kFarthestTurn);
    for (int k = 0; k < 3; ++k) result[k] = Select(isFar, Real(sum[k]), Real(composed[k]));
    return result;
}

// Updates BodyState::halfTurn in a row of displacements from the row's rotation.
template <class Real>
FULCRUM_FORCE_INLINE void SetHalfTurn(Real (&row)[8]) {
    const Vec2<Real> half = HalfTurnOf<Real>(VectorAt<BodyState::kAngular>(row));
    row[BodyState::kHalfTurn] = half.x();
    row[BodyState::kHalfTurn + 1] = half.y();
}

// A unit vector perpendicular to the unit vector n (Duff et al., JCGT 2017).
template <class Real>
inline Vec3<Real> PerpendicularTo(const Vec3<Real>& n) {
    const Real sign = Select(n.z() < Real(0.0f), Real(-1.0f), Real(1.0f));
    const Real a = Real(-1.0f) / (sign + n.z());
    return Vec3<Real>(Real(1.0f) + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x());
}

}  // namespace fulcrum
