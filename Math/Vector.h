// The engine's vectors: Eigen's, in three coordinates. Vector3 (float) is for everything relative to a body, a pair or a
// cell; Position (double) for places in the world. Kernels are templates over Real: float, or Wide<N> for N lanes.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace fulcrum {

template <class Real>
using Vec3 = Eigen::Matrix<Real, 3, 1>;

using Vector3 = Vec3<float>;
using Position = Vec3<double>;

// Products are spelled out, so that no build of Eigen may choose another order of the sums.
template <class Real>
inline Real Dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

template <class Real>
inline Vec3<Real> Cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return Vec3<Real>(a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x());
}

inline float LengthSquared(const Vector3& v) { return Dot(v, v); }
inline float Length(const Vector3& v) { return std::sqrt(Dot(v, v)); }

// v / |v|, or `fallback` where |v| is not larger than 1e-12.
inline Vector3 Normalized(const Vector3& v, const Vector3& fallback = Vector3(0, 1, 0)) {
    const float length = Length(v);
    return length > 1e-12f ? Vector3(v * (1.0f / length)) : fallback;
}

// A unit vector perpendicular to the unit vector n, continuous but for two seams.
// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
inline Vector3 Perpendicular(const Vector3& n) {
    const float sign = std::copysign(1.0f, n.z());
    const float a = -1.0f / (sign + n.z());
    return Vector3(1.0f + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x());
}

inline bool IsFinite(const Vector3& v) {
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}
inline bool IsFinite(const Position& v) {
    return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

}  // namespace fulcrum
