// Inverses of the small symmetric matrices K = J M^-1 J^T of one to three rows, in lanes and without branches. Called
// by the block parts at every set-up. Free functions, no state.
//
// By elimination, K = L D L^T and K^-1 = L^-T D^-1 L^-1. Cofactors over the determinant would need one division instead
// of three, but lose twice the digits: K of an anchor one meter beside a thin axle has eigenvalues 1, 1, 20000, and its
// determinant is lost in the rounding of products of 20000^3. A pivot within rounding error of zero counts as a
// direction in which no body can move; its inverse is zero. The result is a generalized inverse G (K G K = K): the
// remaining rows reach J v + b = 0 wherever possible. K = 0 has G = 0.
#pragma once

#include <Fulcrum/Constraints/Parts/BodySide.h>

namespace fulcrum {

// Two coordinates, not initialized by the default constructor.
template <class Real>
class Vec2 {
public:
    Vec2() = default;
    Vec2(const Real& x, const Real& y) : v_{x, y} {}

    Real& x() { return v_[0]; }
    Real& y() { return v_[1]; }
    const Real& x() const { return v_[0]; }
    const Real& y() const { return v_[1]; }
    static constexpr int size() { return 2; }
    Real& operator[](int axis) { return v_[axis]; }
    const Real& operator[](int axis) const { return v_[axis]; }

    friend Vec2 operator+(const Vec2& a, const Vec2& b) { return {a.v_[0] + b.v_[0], a.v_[1] + b.v_[1]}; }
    friend Vec2 operator-(const Vec2& a, const Vec2& b) { return {a.v_[0] - b.v_[0], a.v_[1] - b.v_[1]}; }
    friend Vec2 operator*(const Vec2& a, const Real& s) { return {a.v_[0] * s, a.v_[1] * s}; }
    Vec2 operator-() const { return {-v_[0], -v_[1]}; }
    friend bool operator==(const Vec2& a, const Vec2& b) { return a.v_[0] == b.v_[0] && a.v_[1] == b.v_[1]; }
    Vec2& operator+=(const Vec2& b) { return *this = *this + b; }
    Vec2& operator*=(const Real& s) { return *this = *this * s; }

private:
    Real v_[2];
};

// Symmetric 2x2 matrix.
template <class Real>
struct Sym2 {
    Real xx = Real(0.0f), yy = Real(0.0f), xy = Real(0.0f);

    Vec2<Real> operator*(const Vec2<Real>& v) const {
        return Vec2<Real>(xx * v.x() + xy * v.y(), xy * v.x() + yy * v.y());
    }
};

namespace detail {

// 1 / pivot. scale: the diagonal, plus the magnitudes subtracted from it during elimination; its rounding error is a
// few times 6e-8 of that. The exact pivot is at least `least`, >= 0.
template <class Real>
inline Real InversePivot(const Real& pivot, const Real& scale, const Real& least) {
    const Real known = Max(pivot, least);
    const MaskOf<Real> stands = (known > scale * Real(1e-6f)) | (least > Real(0.0f));
    return Select(stands, Real(1.0f) / Select(stands, known, Real(1.0f)), Real(0.0f));
}

}  // namespace detail

// k >= 0.
template <class Real>
inline Real SymmetricInverse(Real k) {
    return detail::InversePivot(k, k, Real(0.0f));
}

// Of a positive semi-definite matrix that was computed as a difference. scale: its diagonal before the subtraction,
// whose rounding errors must not count as mobility. least: a lower bound of the eigenvalues, 0 if none is known.
template <class Real>
inline Sym2<Real> SymmetricInverse(const Sym2<Real>& k, const Vec2<Real>& scale, const Real& least) {
    const Real dx = detail::InversePivot(k.xx, scale.x(), least);
    const Real l = k.xy * dx;
    const Real dy = detail::InversePivot(k.yy - k.xy * l, scale.y() + l * l * scale.x(), least);
    Sym2<Real> inverse;
    inverse.yy = dy;
    inverse.xy = -(l * dy);
    inverse.xx = dx + l * l * dy;
    return inverse;
}

template <class Real>
inline Sym3<Real> SymmetricInverse(const Sym3<Real>& k, const Vec3<Real>& scale, const Real& least) {
    const Real dx = detail::InversePivot(k.xx, scale.x(), least);
    const Real lxy = k.xy * dx, lxz = k.xz * dx;
    const Real yz = k.yz - k.xy * lxz;
    // The factors amplify rounding errors, lyz especially if the first two rows are nearly equal.
    const Real y = scale.y() + lxy * lxy * scale.x();
    const Real dy = detail::InversePivot(k.yy - k.xy * lxy, y, least);
    const Real lyz = yz * dy;
    const Real z = scale.z() + lxz * lxz * scale.x() + lyz * lyz * y;
    const Real dz = detail::InversePivot(k.zz - k.xz * lxz - yz * lyz, z, least);
    const Real corner = lxy * lyz - lxz;  // of L^-1
    Sym3<Real> inverse;
    inverse.zz = dz;
    inverse.yz = -(lyz * dz);
    inverse.xz = corner * dz;
    inverse.yy = dy + lyz * lyz * dz;
    inverse.xy = -(lxy * dy + lyz * corner * dz);
    inverse.xx = dx + lxy * lxy * dy + corner * corner * dz;
    return inverse;
}

// Positive semi-definite.
template <class Real>
inline Sym2<Real> SymmetricInverse(const Sym2<Real>& k) {
    return SymmetricInverse(k, Vec2<Real>(k.xx, k.yy), Real(0.0f));
}
template <class Real>
inline Sym3<Real> SymmetricInverse(const Sym3<Real>& k) {
    return SymmetricInverse(k, Vec3<Real>(k.xx, k.yy, k.zz), Real(0.0f));
}

}  // namespace fulcrum
