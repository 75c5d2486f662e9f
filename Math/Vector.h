// The engine's vectors, of three coordinates. Vector3 (float) is for everything relative to a body, a pair or a cell;
// Position (double) for positions in the world. Kernels are templates over Real: float, double, or Wide<N> for N lanes.
//
// Own class instead of Eigen's, which is slow to compile (Docs/Architecture.md). Members that Eigen has, too, have the
// same names and meaning. Vectors convert implicitly from Eigen's expressions, and to Eigen's vectors in copies and
// assignments (Eigen::Vector3f e = v), wherever Eigen is included.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstdlib>
#include <iosfwd>
#include <type_traits>

namespace Eigen {
template <class Derived>
class MatrixBase;
template <class Scalar, int kRows, int kColumns, int kOptions, int kMaxRows, int kMaxColumns>
class Matrix;
}  // namespace Eigen

namespace fulcrum {

namespace detail {

// Without <cmath>, which takes a tenth of the time that Fulcrum.h compiles; the same bits as std::sqrt.
inline float SquareRoot(float a) { return __builtin_sqrtf(a); }
inline double SquareRoot(double a) { return __builtin_sqrt(a); }

}  // namespace detail

// Not initialized by its default constructor.
template <class Real>
class Vec3 {
public:
    Vec3() = default;
    Vec3(const Real& x, const Real& y, const Real& z) : v_{x, y, z} {}
    template <class Derived>
    Vec3(const Eigen::MatrixBase<Derived>& m) : Vec3(FromEigen(typename Eigen::MatrixBase<Derived>::PlainObject(m))) {}

    static Vec3 Constant(const Real& value) { return {value, value, value}; }
    static Vec3 Zero() { return Constant(Real(0.0f)); }
    static Vec3 Ones() { return Constant(Real(1.0f)); }
    static Vec3 UnitX() { return {Real(1.0f), Real(0.0f), Real(0.0f)}; }
    static Vec3 UnitY() { return {Real(0.0f), Real(1.0f), Real(0.0f)}; }
    static Vec3 UnitZ() { return {Real(0.0f), Real(0.0f), Real(1.0f)}; }
    // The unit vector of an axis, 0 to 2.
    static Vec3 Unit(int axis) {
        Vec3 v = Zero();
        v[axis] = Real(1.0f);
        return v;
    }

    Real& x() { return v_[0]; }
    Real& y() { return v_[1]; }
    Real& z() { return v_[2]; }
    const Real& x() const { return v_[0]; }
    const Real& y() const { return v_[1]; }
    const Real& z() const { return v_[2]; }
    static constexpr int size() { return 3; }
    // axis: 0 to 2.
    template <class Index>
    Real& operator[](Index axis) {
        return v_[axis];
    }
    template <class Index>
    const Real& operator[](Index axis) const {
        return v_[axis];
    }
    Real* data() { return v_; }
    const Real* data() const { return v_; }
    void setZero() { *this = Zero(); }

    friend Vec3 operator+(const Vec3& a, const Vec3& b) {
        return {a.v_[0] + b.v_[0], a.v_[1] + b.v_[1], a.v_[2] + b.v_[2]};
    }
    friend Vec3 operator-(const Vec3& a, const Vec3& b) {
        return {a.v_[0] - b.v_[0], a.v_[1] - b.v_[1], a.v_[2] - b.v_[2]};
    }
    friend Vec3 operator*(const Vec3& a, const Real& s) { return {a.v_[0] * s, a.v_[1] * s, a.v_[2] * s}; }
    friend Vec3 operator*(const Real& s, const Vec3& a) { return {s * a.v_[0], s * a.v_[1], s * a.v_[2]}; }
    friend Vec3 operator/(const Vec3& a, const Real& s) { return {a.v_[0] / s, a.v_[1] / s, a.v_[2] / s}; }
    Vec3 operator-() const { return {-v_[0], -v_[1], -v_[2]}; }
    Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
    Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
    Vec3& operator*=(const Real& s) { return *this = *this * s; }
    Vec3& operator/=(const Real& s) { return *this = *this / s; }
    friend bool operator==(const Vec3& a, const Vec3& b) {
        return a.v_[0] == b.v_[0] && a.v_[1] == b.v_[1] && a.v_[2] == b.v_[2];
    }

    template <class Other>
    Vec3<Other> cast() const {
        return {static_cast<Other>(v_[0]), static_cast<Other>(v_[1]), static_cast<Other>(v_[2])};
    }

    Vec3 cwiseAbs() const {
        using std::abs;
        return {abs(v_[0]), abs(v_[1]), abs(v_[2])};
    }
    Vec3 cwiseProduct(const Vec3& b) const { return {v_[0] * b.v_[0], v_[1] * b.v_[1], v_[2] * b.v_[2]}; }
    Vec3 cwiseQuotient(const Vec3& b) const { return {v_[0] / b.v_[0], v_[1] / b.v_[1], v_[2] / b.v_[2]}; }
    // If a coordinate of b is NaN, that of this vector is kept.
    Vec3 cwiseMin(const Vec3& b) const { return {Min(v_[0], b.v_[0]), Min(v_[1], b.v_[1]), Min(v_[2], b.v_[2])}; }
    Vec3 cwiseMax(const Vec3& b) const { return {Max(v_[0], b.v_[0]), Max(v_[1], b.v_[1]), Max(v_[2], b.v_[2])}; }
    Vec3 cwiseMin(const Real& limit) const { return cwiseMin(Constant(limit)); }
    Vec3 cwiseMax(const Real& limit) const { return cwiseMax(Constant(limit)); }
    Real minCoeff() const { return Min(v_[0], Min(v_[1], v_[2])); }
    Real maxCoeff() const { return Max(v_[0], Max(v_[1], v_[2])); }
    Real sum() const { return v_[0] + (v_[1] + v_[2]); }
    // Whether each coordinate is at most `tolerance` from 0.
    bool isZero(const Real& tolerance) const { return cwiseAbs().isAtMost(Constant(tolerance)); }
    // Whether every coordinate is <=, or <, that of b.
    bool isAtMost(const Vec3& b) const { return v_[0] <= b.v_[0] && v_[1] <= b.v_[1] && v_[2] <= b.v_[2]; }
    bool isBelow(const Vec3& b) const { return v_[0] < b.v_[0] && v_[1] < b.v_[1] && v_[2] < b.v_[2]; }

    Real dot(const Vec3& b) const { return v_[0] * b.v_[0] + v_[1] * b.v_[1] + v_[2] * b.v_[2]; }
    Vec3 cross(const Vec3& b) const {
        return {v_[1] * b.v_[2] - v_[2] * b.v_[1], v_[2] * b.v_[0] - v_[0] * b.v_[2],
                v_[0] * b.v_[1] - v_[1] * b.v_[0]};
    }
    Real squaredNorm() const { return dot(*this); }
    Real norm() const { return detail::SquareRoot(squaredNorm()); }
    Vec3 normalized() const { return *this / norm(); }

    template <class EigenVector>
    requires std::is_same_v<EigenVector, Eigen::Matrix<Real, 3, 1, 0, 3, 1>>
    operator EigenVector() const { return EigenVector(v_[0], v_[1], v_[2]); }

    // "x y z"
    template <class Char, class Traits>
    friend std::basic_ostream<Char, Traits>& operator<<(std::basic_ostream<Char, Traits>& stream, const Vec3& v) {
        return stream << v.v_[0] << ' ' << v.v_[1] << ' ' << v.v_[2];
    }

private:
    template <class Plain>
    static Vec3 FromEigen(const Plain& m) {
        static_assert(Plain::RowsAtCompileTime == 3 && Plain::ColsAtCompileTime == 1 &&
                          std::is_same_v<typename Plain::Scalar, Real>,
                      "a vector of three coordinates of the same type is needed");
        return {m.coeff(0), m.coeff(1), m.coeff(2)};
    }
    static Real Min(const Real& a, const Real& b) { return b < a ? b : a; }
    static Real Max(const Real& a, const Real& b) { return a < b ? b : a; }

    Real v_[3];
};

using Vector3 = Vec3<float>;
using Position = Vec3<double>;

// The order of these sums is part of the engine's results.
template <class Real>
inline Real Dot(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.dot(b);
}

template <class Real>
inline Vec3<Real> Cross(const Vec3<Real>& a, const Vec3<Real>& b) {
    return a.cross(b);
}

inline float LengthSquared(const Vector3& v) { return Dot(v, v); }
inline float Length(const Vector3& v) { return detail::SquareRoot(Dot(v, v)); }

// v / |v|, or `fallback` if |v| is not larger than 1e-12.
inline Vector3 Normalized(const Vector3& v, const Vector3& fallback = Vector3(0, 1, 0)) {
    const float length = Length(v);
    return length > 1e-12f ? Vector3(v * (1.0f / length)) : fallback;
}

// A unit vector perpendicular to the unit vector n, continuous except at two seams.
// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
inline Vector3 Perpendicular(const Vector3& n) {
    const float sign = __builtin_copysignf(1.0f, n.z());
    const float a = -1.0f / (sign + n.z());
    return Vector3(1.0f + sign * n.x() * n.x() * a, sign * n.x() * n.y() * a, -sign * n.x());
}

inline bool IsFinite(const Vector3& v) {
    return __builtin_isfinite(v.x()) && __builtin_isfinite(v.y()) && __builtin_isfinite(v.z());
}
inline bool IsFinite(const Position& v) {
    return __builtin_isfinite(v.x()) && __builtin_isfinite(v.y()) && __builtin_isfinite(v.z());
}

}  // namespace fulcrum
