// Rotation as a unit quaternion, over one scalar or over lanes. Products are written out so that results are
// bit-identical.
#pragma once

#include <Fulcrum/Math/ForceInline.h>
#include <Fulcrum/Math/Vector.h>

namespace fulcrum {

template <class Real>
struct Quat {
    Real x = Real(0.0f), y = Real(0.0f), z = Real(0.0f), w = Real(1.0f);

    Vec3<Real> Imaginary() const { return Vec3<Real>(x, y, z); }
    Quat Conjugate() const { return {-x, -y, -z, w}; }
};

using Quaternion = Quat<float>;

// The rotation b followed by the rotation a.
template <class Real>
inline Quat<Real> operator*(const Quat<Real>& a, const Quat<Real>& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

// Inlined by force: calls that pass both through memory are a tenth of the narrow phase.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Rotate(const Quat<Real>& q, const Vec3<Real>& v) {
    const Vec3<Real> u = q.Imaginary();
    const Vec3<Real> t = Cross<Real>(u, v) * Real(2.0f);
    return v + t * q.w + Cross<Real>(u, t);
}

template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> InverseRotate(const Quat<Real>& q, const Vec3<Real>& v) {
    return Rotate(q.Conjugate(), v);
}

inline float LengthSquared(const Quaternion& q) { return q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w; }

inline Quaternion Normalized(const Quaternion& q) {
    const float scale = 1.0f / detail::SquareRoot(LengthSquared(q));
    return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
}

inline bool IsFinite(const Quaternion& q) {
    return __builtin_isfinite(q.x) && __builtin_isfinite(q.y) && __builtin_isfinite(q.z) && __builtin_isfinite(q.w);
}

}  // namespace fulcrum
