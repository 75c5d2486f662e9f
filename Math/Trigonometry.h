// Sine, arc tangent, exponential and related functions with the same bits on every machine: made of + - * / sqrt,
// comparisons and bit operations only. Used wherever the engine turns angles into rotations and back. Free functions,
// no state.
//
// Unless stated otherwise, a function takes Real = float, double or, for angles, Wide<N>, whose lanes give the bits of
// float. Arguments must be finite. The errors are the largest measured, in units of the result's last place: over every
// float from 2^-13 up, and over millions of doubles and pairs.
#pragma once

#include <Fulcrum/Math/Quaternion.h>
#include <Fulcrum/Math/Wide.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace fulcrum {

namespace detail {

// Scalar operations in double beside those of float and lanes.
using fulcrum::Abs;
using fulcrum::Max;
using fulcrum::Min;
using fulcrum::Select;
using fulcrum::Sqrt;
inline double Select(bool mask, double a, double b) { return mask ? a : b; }
inline double Min(double a, double b) { return a < b ? a : b; }
inline double Max(double a, double b) { return a > b ? a : b; }
inline double Abs(double a) { return a < 0.0 ? -a : a; }
inline double Sqrt(double a) { return detail::SquareRoot(a); }

template <class Real>
inline constexpr bool kIsDouble = std::is_same_v<Real, double>;

// The nearest integer, ties to even: adding 1.5 * 2^(digits - 1) rounds the fraction away. |x| < 2^22 (float), 2^51
// (double).
template <class Real>
inline Real Round(const Real& x) {
    const Real shift = kIsDouble<Real> ? Real(6755399441055744.0) : Real(12582912.0f);
    return (x + shift) - shift;
}

// c[0] x^(N-1) + ... + c[N-1]
template <class Real, class Scalar, size_t N>
inline Real Polynomial(const Real& x, const Scalar (&c)[N]) {
    Real sum(c[0]);
    for (size_t i = 1; i < N; ++i) sum = sum * x + Real(c[i]);
    return sum;
}

// The coefficients below minimize the largest relative error (Remez exchange), which stays under 2^-30 for float and
// 2^-57 for double. (sin r - r) / r^3 and (cos r - 1 + r^2 / 2) / r^4 in r^2, |r| <= 0.786 (0.83 for float):
inline constexpr float kSineFloat[] = {0x1.6c3b3ap-19f, -0x1.a00ce4p-13f, 0x1.111106p-7f, -0x1.555556p-3f};
inline constexpr float kCosineFloat[] = {0x1.9930d2p-16f, -0x1.6c098cp-10f, 0x1.555546p-5f};
inline constexpr double kSineDouble[] = {0x1.5d8e6976280bfp-33,  -0x1.ae5e55d9cb206p-26, 0x1.71de3561fbc9ap-19,
                                         -0x1.a01a019bf76c0p-13, 0x1.111111110f79ep-7,   -0x1.5555555555548p-3};
inline constexpr double kCosineDouble[] = {-0x1.8fa30a01d4ad0p-37, 0x1.1ee9d4c1615c5p-29,  -0x1.27e4f7e687395p-22,
                                           0x1.a01a019c7e95fp-16,  -0x1.6c16c16c14f58p-10, 0x1.555555555554bp-5};
// (atan r - r) / r^3 in r^2, |r| <= tan(pi / 8):
inline constexpr float kArcTangentFloat[] = {-0x1.f1ebf0p-5f, 0x1.b1ebe2p-4f, -0x1.23b51ep-3f, 0x1.999196p-3f,
                                             -0x1.55554ap-2f};
inline constexpr double kArcTangentDouble[] = {0x1.f1e1a55494a48p-7,  -0x1.1235a3922a33bp-5, 0x1.70ec38bc72975p-5,
                                               -0x1.ab7d3466bd0bbp-5, 0x1.e171f2e8857c7p-5,  -0x1.110c721413b33p-4,
                                               0x1.3b136e20734cdp-4,  -0x1.745d14b921679p-4, 0x1.c71c71b7465dep-4,
                                               -0x1.249249247566dp-3, 0x1.999999999964bp-3,  -0x1.5555555555554p-2};
// (exp r - 1 - r) / r^2 in r, |r| <= ln(2) / 2:
inline constexpr double kExponential[] = {0x1.1e3d1a4c5f1edp-29, 0x1.af6c0baf497c7p-26, 0x1.27e5b475b2140p-22,
                                          0x1.71ddf00cae3bdp-19, 0x1.a01a01366559ep-16, 0x1.a01a01b38616fp-13,
                                          0x1.6c16c16c3056ap-10, 0x1.111111110ec4ap-7,  0x1.5555555555503p-5,
                                          0x1.555555555555bp-3,  0x1.0000000000000p-1};
// (2 artanh(s) / s - 2) / s^2 in s^2, |s| <= 0.1716:
inline constexpr double kLogarithm[] = {0x1.2f07f7a4358ffp-3, 0x1.39a17c587e01bp-3, 0x1.74664132d20cdp-3,
                                        0x1.c71c51fed822bp-3, 0x1.24924941fd400p-2, 0x1.999999997fcedp-2,
                                        0x1.5555555555592p-1};

// A number as the sum of two, of which `low` is the smaller by the width of a mantissa.
template <class Real>
struct TwoParts {
    Real high, low;
};

// a - b and its rounding error (Knuth).
template <class Real>
inline TwoParts<Real> Difference(const Real& a, const Real& b) {
    const Real difference = a - b;
    const Real back = difference - a;
    return {difference, (a - (difference - back)) - (b + back)};
}

// x - k pi / 2 for the integer k next to x / (pi / 2). pi / 2 comes in parts of so few digits that k times a part is
// exact (float: the high and the low half of k times a part), which the reduction needs where x is near a multiple of
// pi / 2.
template <class Real>
inline TwoParts<Real> ReduceAngle(const Real& x, Real& k) {
    TwoParts<Real> sum;
    Real rest;
    if constexpr (kIsDouble<Real>) {
        k = Round(x * 0x1.45f306dc9c883p-1);
        sum = Difference(x - k * 0x1.921fb544p+0, k * 0x1.0b4611a6p-34);
        rest = sum.low - k * 0x1.3198a2e037073p-69;
    } else {
        k = Round(x * Real(0x1.45f306p-1f));
        const Real kHigh = Round(k * Real(0x1p-10f)) * Real(0x1p10f);
        const Real kLow = k - kHigh;
        const Real second(-0x1.2afp-18f), third(0x1.0b48p-34f);
        const Real first = (x - kHigh * Real(0x1.922p+0f)) - kLow * Real(0x1.922p+0f);
        const TwoParts<Real> a = Difference(first, kHigh * second);
        const TwoParts<Real> b = Difference(a.high, kLow * second);
        const TwoParts<Real> c = Difference(b.high, kHigh * third);
        sum = Difference(c.high, kLow * third);
        rest = ((a.low + b.low) + (c.low + sum.low)) - k * Real(-0x1.ee59dap-50f);
    }
    const Real high = sum.high + rest;
    return {high, (sum.high - high) + rest};
}

// e^x = 2^k e^r.
inline double ScaleByPowerOfTwo(double x, int k) {
    const auto power = [](int e) { return std::bit_cast<double>(static_cast<uint64_t>(e + 1023) << 52); };
    return x * power(k / 2) * power(k - k / 2);  // in two halves: 2^k alone may be no normal number
}

}  // namespace detail

template <class Real>
struct SineCosine {
    Real sine, cosine;
};

// x in radians, |x| <= 1e6. Error: float 0.83, double 1.1.
template <class Real>
requires(!std::is_integral_v<Real>) inline SineCosine<Real> SinCos(const Real& x) {
    Real k;
    const detail::TwoParts<Real> r = detail::ReduceAngle(x, k);
    const Real square = r.high * r.high, half = Real(0.5f) * square, one(1.0f);
    Real sineTail, cosineTail;
    if constexpr (detail::kIsDouble<Real>) {
        sineTail = detail::Polynomial(square, detail::kSineDouble);
        cosineTail = detail::Polynomial(square, detail::kCosineDouble);
    } else {
        sineTail = detail::Polynomial(square, detail::kSineFloat);
        cosineTail = detail::Polynomial(square, detail::kCosineFloat);
    }
    const Real sine = r.high + (r.high * square * sineTail + r.low * (one - half));
    const Real rough = one - half;
    const Real cosine = rough + (((one - rough) - half) + (square * square * cosineTail - r.high * r.low));

    // The quadrant, 0 .. 3. Odd ones swap the two; 2 and 3 turn the sine's sign, 1 and 2 the cosine's.
    const Real quadrant = k - Real(4.0f) * detail::Round(k * Real(0.25f) - Real(0.375f));
    using detail::Abs;
    using detail::Select;
    const auto isOdd = Abs(quadrant - Real(2.0f)) == one;
    const Real s = Select(isOdd, cosine, sine), c = Select(isOdd, sine, cosine);
    return {Select(quadrant > Real(1.5f), -s, s), Select(Abs(quadrant - Real(1.5f)) < one, -c, c)};
}

template <class Real>
inline Real Sin(const Real& x) {
    return SinCos(x).sine;
}
template <class Real>
inline Real Cos(const Real& x) {
    return SinCos(x).cosine;
}

// The angle of the point (x, y), -pi .. pi; 0 at the origin. Zeros count as positive, whatever their sign.
// |x|, |y| below half the largest number. Error: float 2.2, double 2.4.
template <class Real>
requires(!std::is_integral_v<Real>) inline Real Atan2(const Real& y, const Real& x) {
    using detail::Abs, detail::Max, detail::Min, detail::Select;
    const Real zero(0.0f), one(1.0f);
    const Real absX = Abs(x), absY = Abs(y);
    const Real large = Max(absX, absY), small = Min(absX, absY);
    // The angle from the nearest multiple of pi / 4, at most pi / 8 either way.
    const auto isSteep = small > large * Real(0.41421356f);
    const Real numerator = Select(isSteep, small - large, small);
    const Real denominator = Select(isSteep, small + large, large);
    const Real t = numerator / Select(denominator > zero, denominator, one);
    const Real square = t * t;
    Real tail;
    if constexpr (detail::kIsDouble<Real>) tail = detail::Polynomial(square, detail::kArcTangentDouble);
    else tail = detail::Polynomial(square, detail::kArcTangentFloat);
    Real angle = t + t * square * tail;
    // Unfolded to the octant: angle = eighths pi / 4 +- angle.
    Real eighths = Select(isSteep, one, zero);
    const auto isUpright = absY > absX;
    eighths = Select(isUpright, Real(2.0f) - eighths, eighths);
    angle = Select(isUpright, -angle, angle);
    const auto isBehind = x < zero;
    eighths = Select(isBehind, Real(4.0f) - eighths, eighths);
    angle = Select(isBehind, -angle, angle);
    // pi / 4 in two parts, of which the first has two spare digits: eighths times it is exact.
    Real high, low;
    if constexpr (detail::kIsDouble<Real>) high = 0x1.921fb54442d18p-1, low = 0x1.1a62633145c07p-55;
    else high = Real(0x1.921fb8p-1f), low = Real(-0x1.5dde98p-24f);
    const Real result = eighths * high + (angle + eighths * low);
    return Select(y < zero, -result, result);
}

// 0 .. pi. Arguments are clamped to -1..1. Error: float 2.9, double 3.0.
template <class Real>
requires(!std::is_integral_v<Real>) inline Real Acos(const Real& x) {
    const Real one(1.0f);
    const Real cosine = detail::Max(-one, detail::Min(one, x));
    return Atan2(detail::Sqrt((one - cosine) * (one + cosine)), cosine);
}

// -pi/2 .. pi/2. Arguments beyond -1 .. 1 count as -1 and 1. Error: float 2.9, double 3.0.
template <class Real>
requires(!std::is_integral_v<Real>) inline Real Asin(const Real& x) {
    const Real one(1.0f);
    const Real sine = detail::Max(-one, detail::Min(one, x));
    return Atan2(sine, detail::Sqrt((one - sine) * (one + sine)));
}

// e^x; infinite above 709.78, 0 below -745.13, NaN for NaN. Error: 0.95 (float 0.51).
inline double Exp(double x) {
    if (x > 709.782712893384) return std::numeric_limits<double>::infinity();
    if (x < -745.133219101941) return 0.0;
    if (x != x) return x;
    const double k = detail::Round(x * 0x1.71547652b82fep+0);
    const double r = (x - k * 0x1.62e42ffp-1) - k * -0x1.718432a1b0e26p-35;
    return detail::ScaleByPowerOfTwo(1.0 + (r + r * r * detail::Polynomial(r, detail::kExponential)),
                                     static_cast<int>(k));
}
inline float Exp(float x) { return static_cast<float>(Exp(static_cast<double>(x))); }

// The natural logarithm; -infinite for 0, NaN below. Error: 0.85 (float 0.51).
inline double Log(double x) {
    if (!(x > 0.0))
        return x == 0.0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
    if (x > std::numeric_limits<double>::max()) return x;
    // x = 2^k m, m between sqrt(1/2) and sqrt(2).
    const bool isSubnormal = x < std::numeric_limits<double>::min();
    const auto bits = std::bit_cast<uint64_t>(isSubnormal ? x * 0x1p54 : x);
    const uint64_t fromRootHalf = bits - 0x3fe6a09e667f3bcdu;  // the bits of sqrt(1/2)
    const auto exponent = static_cast<int>(static_cast<int64_t>(fromRootHalf) >> 52);
    const auto m = std::bit_cast<double>(bits - (static_cast<uint64_t>(exponent) << 52));
    const double k = exponent - (isSubnormal ? 54 : 0);
    // log(1 + f) = 2 artanh(s), s = f / (2 + f), written as f less a small correction, so that f's digits count.
    const double f = m - 1.0, half = 0.5 * f * f, s = f / (2.0 + f), square = s * s;
    const double tail = square * detail::Polynomial(square, detail::kLogarithm);
    return k * 0x1.62e42ffp-1 + (f - (half - (s * (half + tail) + k * -0x1.718432a1b0e26p-35)));
}
inline float Log(float x) { return static_cast<float>(Log(static_cast<double>(x))); }

// The rotation by |v| radians about v, for any angle up to 1e6; the identity for v = 0. The exponential map.
template <class Real>
inline Quat<Real> RotationFromVector(const Vec3<Real>& v) {
    using detail::Select, detail::Sqrt;
    const Real square = Dot<Real>(v, v);
    const Real angle = Sqrt(square);
    const SineCosine<Real> half = SinCos<Real>(angle * Real(0.5f));
    // sin(a / 2) / a = 1/2 - a^2 / 48 + a^4 / 3840 - ...: the next term is below a digit there (in double too).
    const auto isSmall = square < Real(1e-7f);
    const Real series = Real(0.5f) - square * (Real(1.0f) / Real(48.0f) - square * (Real(1.0f) / Real(3840.0f)));
    const Real scale = Select(isSmall, series, half.sine / Select(isSmall, Real(1.0f), angle));
    return {v.x() * scale, v.y() * scale, v.z() * scale, half.cosine};
}
inline Quaternion RotationFromVector(const Vector3& v) { return RotationFromVector<float>(v); }

// The rotation by `angle` radians about a unit axis.
inline Quaternion RotationAbout(const Vector3& axis, double angle) {
    const Vector3 imaginary = axis * static_cast<float>(Sin(0.5 * angle));
    return {imaginary.x(), imaginary.y(), imaginary.z(), static_cast<float>(Cos(0.5 * angle))};
}

// The shortest vector with RotationFromVector(v) = q or -q, |v| <= pi; q's length need not be exactly 1. The logarithm
// map.
template <class Real>
inline Vec3<Real> RotationVectorOf(const Quat<Real>& q) {
    using detail::Select, detail::Sqrt;
    const Real zero(0.0f);
    const auto isFar = q.w < zero;
    const Real w = Select(isFar, -q.w, q.w);
    const Vec3<Real> u = q.Imaginary() * Select(isFar, Real(-1.0f), Real(1.0f));
    const Real square = Dot<Real>(u, u);
    const Real sine = Sqrt(square);
    // 2 atan(t) / (t w) = 2 / w (1 - t^2 / 3 + t^4 / 5 - ...), t = sine / w.
    const auto isSmall = square < w * w * Real(1e-7f);
    const Real safeW = Select(isSmall, w, Real(1.0f));
    const Real t2 = square / (safeW * safeW);
    const Real series =
        Real(2.0f) / safeW * (Real(1.0f) - t2 * (Real(1.0f) / Real(3.0f) - t2 * (Real(1.0f) / Real(5.0f))));
    const Real scale = Select(isSmall, series, Real(2.0f) * Atan2(sine, w) / Select(isSmall, Real(1.0f), sine));
    return u * scale;
}

}  // namespace fulcrum
