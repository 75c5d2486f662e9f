// 3x3 matrices of the engine: a general one by its columns, and a symmetric one (inertia) by six numbers.
#pragma once

#include <Fulcrum/Math/Quaternion.h>

namespace fulcrum {

// Columns x, y, z. A rotation's columns are the body's axes in world space.
template <class Real>
struct Mat3 {
    Vec3<Real> x, y, z;

    Vec3<Real> operator*(const Vec3<Real>& v) const { return x * v.x() + y * v.y() + z * v.z(); }
    Vec3<Real> TransposeMultiply(const Vec3<Real>& v) const {
        return Vec3<Real>(Dot<Real>(x, v), Dot<Real>(y, v), Dot<Real>(z, v));
    }
    Mat3 Transposed() const {
        return {Vec3<Real>(x.x(), y.x(), z.x()), Vec3<Real>(x.y(), y.y(), z.y()), Vec3<Real>(x.z(), y.z(), z.z())};
    }
};

using Matrix3 = Mat3<float>;

template <class Real>
inline Mat3<Real> ToMatrix(const Quat<Real>& q) {
    const Real one(1.0f);
    const Real x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
    const Real xx = q.x * x2, yy = q.y * y2, zz = q.z * z2;
    const Real xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
    const Real wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    return {Vec3<Real>(one - (yy + zz), xy + wz, xz - wy), Vec3<Real>(xy - wz, one - (xx + zz), yz + wx),
            Vec3<Real>(xz + wy, yz - wx, one - (xx + yy))};
}

// a^T b: the rotation of frame b relative to frame a.
template <class Real>
inline Mat3<Real> TransposeMultiply(const Mat3<Real>& a, const Mat3<Real>& b) {
    return {a.TransposeMultiply(b.x), a.TransposeMultiply(b.y), a.TransposeMultiply(b.z)};
}

// Symmetric 3x3 matrix.
template <class Real>
struct Sym3 {
    Real xx = Real(0.0f), yy = Real(0.0f), zz = Real(0.0f), xy = Real(0.0f), xz = Real(0.0f), yz = Real(0.0f);

    Vec3<Real> operator*(const Vec3<Real>& v) const {
        return Vec3<Real>(xx * v.x() + xy * v.y() + xz * v.z(), xy * v.x() + yy * v.y() + yz * v.z(),
                          xz * v.x() + yz * v.y() + zz * v.z());
    }
};

using SymmetricMatrix3 = Sym3<float>;

// R diag(d) R^T, the tensor with principal values d along the columns of R.
template <class Real>
inline Sym3<Real> RotatedDiagonal(const Mat3<Real>& r, const Vec3<Real>& d) {
    const Vec3<Real> x = r.x * d.x(), y = r.y * d.y(), z = r.z * d.z();
    Sym3<Real> s;
    s.xx = x.x() * r.x.x() + y.x() * r.y.x() + z.x() * r.z.x();
    s.yy = x.y() * r.x.y() + y.y() * r.y.y() + z.y() * r.z.y();
    s.zz = x.z() * r.x.z() + y.z() * r.y.z() + z.z() * r.z.z();
    s.xy = x.x() * r.x.y() + y.x() * r.y.y() + z.x() * r.z.y();
    s.xz = x.x() * r.x.z() + y.x() * r.y.z() + z.x() * r.z.z();
    s.yz = x.y() * r.x.z() + y.y() * r.y.z() + z.y() * r.z.z();
    return s;
}

}  // namespace fulcrum
