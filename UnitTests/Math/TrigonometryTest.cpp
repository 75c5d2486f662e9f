#include <Fulcrum/Math/Trigonometry.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fulcrum {
namespace {

// Errors are in units of the exact value's last place. The reference is the system's long double function (x86: 11 bits
// more than double); where long double is double it is off by up to 1 itself, which the bounds leave room for.
template <class Real>
double ErrorInUlps(Real actual, long double exact) {
    int exponent;
    std::frexp(exact, &exponent);
    exponent = std::max(exponent, std::numeric_limits<Real>::min_exponent);
    const long double ulp = std::ldexp(1.0L, exponent - std::numeric_limits<Real>::digits);
    return static_cast<double>(std::fabs(static_cast<long double>(actual) - exact) / ulp);
}

template <class Real>
struct Worst {
    void Add(Real actual, long double exact, Real x) {
        const double error = ErrorInUlps(actual, exact);
        if (error <= value) return;  // a NaN goes on
        value = error;
        at = x;
    }
    double value = 0;
    Real at = 0;
};

// `count` values per power of two from 2^low to 2^high and their negatives, spread over the mantissa.
template <class Real, class F>
void ForEachMagnitude(int low, int high, int count, F f) {
    for (int exponent = low; exponent < high; ++exponent)
        for (int i = 0; i < count; ++i) {
            const Real fraction = static_cast<Real>(std::fmod(i * 0.6180339887498949, 1.0));
            const Real x = std::ldexp(Real(1) + fraction, exponent);
            f(x);
            f(-x);
        }
}

template <class Real>
class Trigonometry : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Trigonometry, Reals);

TYPED_TEST(Trigonometry, SineAndCosineAreExactToTwoUlps) {
    using Real = TypeParam;
    Worst<Real> sine, cosine;
    const auto check = [&](Real x) {
        if (std::fabs(x) > 1e6) return;
        const SineCosine<Real> actual = SinCos(x);
        sine.Add(actual.sine, std::sin(static_cast<long double>(x)), x);
        cosine.Add(actual.cosine, std::cos(static_cast<long double>(x)), x);
        ASSERT_EQ(Sin(x), actual.sine);
        ASSERT_EQ(Cos(x), actual.cosine);
    };
    ForEachMagnitude<Real>(-30, 20, 3000, check);
    // Next to the multiples of pi / 2, where the argument's reduction decides the result's digits.
    for (int k = 0; k < 636000; k += 7) check(static_cast<Real>(k * (std::numbers::pi_v<long double> / 2)));
    EXPECT_LT(sine.value, 2.0) << sine.at;
    EXPECT_LT(cosine.value, 2.0) << cosine.at;
    EXPECT_EQ(Sin(Real(0)), Real(0));
    EXPECT_EQ(Cos(Real(0)), Real(1));
}

TYPED_TEST(Trigonometry, ArcTangentIsExactInAllDirections) {
    using Real = TypeParam;
    Worst<Real> error;
    const auto check = [&](Real y, Real x) {
        error.Add(Atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x)), y / x);
    };
    ForEachMagnitude<Real>(-30, 30, 2000, [&](Real slope) {
        check(slope, 1);
        check(slope, -1);
        check(3 * slope, 3);
        check(1, slope);
    });
    EXPECT_LT(error.value, 3.0) << error.at;  // three rounded operations before the last sum, each half a unit, or one
}

TYPED_TEST(Trigonometry, ArcTangentOnTheAxes) {
    using Real = TypeParam;
    const Real pi = std::numbers::pi_v<Real>;
    EXPECT_EQ(Atan2(Real(0), Real(0)), Real(0));
    EXPECT_EQ(Atan2(Real(0), Real(2)), Real(0));
    EXPECT_EQ(Atan2(Real(2), Real(0)), pi / 2);
    EXPECT_EQ(Atan2(Real(-2), Real(0)), -pi / 2);
    EXPECT_EQ(Atan2(Real(0), Real(-2)), pi);
    EXPECT_EQ(Atan2(Real(3), Real(3)), pi / 4);
    EXPECT_EQ(Atan2(Real(-3), Real(-3)), -3 * (pi / 4));
}

TYPED_TEST(Trigonometry, ArcSineAndArcCosineAreExact) {
    using Real = TypeParam;
    Worst<Real> sine, cosine;
    const auto check = [&](Real x) {
        sine.Add(Asin(x), std::asin(static_cast<long double>(x)), x);
        cosine.Add(Acos(x), std::acos(static_cast<long double>(x)), x);
    };
    ForEachMagnitude<Real>(-30, 0, 3000, [&](Real x) {
        check(x);
        check(x > 0 ? 1 - x : -1 - x);
    });
    EXPECT_LT(sine.value, 4.0) << sine.at;  // the arc tangent's error and that of a rounded square root of a product
    EXPECT_LT(cosine.value, 4.0) << cosine.at;
    EXPECT_EQ(Acos(Real(1)), Real(0));
    EXPECT_EQ(Acos(Real(7)), Real(0));
    EXPECT_EQ(Acos(Real(-7)), std::numbers::pi_v<Real>);
    EXPECT_EQ(Asin(Real(7)), std::numbers::pi_v<Real> / 2);
}

TYPED_TEST(Trigonometry, ExponentialAndLogarithmAreExact) {
    using Real = TypeParam;
    Worst<Real> exponential, logarithm;
    const Real largest = std::is_same_v<Real, float> ? Real(88.7) : Real(709.7);
    const int exponents = std::numeric_limits<Real>::max_exponent;
    ForEachMagnitude<Real>(-30, 10, 2000, [&](Real x) {
        if (std::fabs(x) < largest) exponential.Add(Exp(x), std::exp(static_cast<long double>(x)), x);
        const Real nearOne = Real(1) + x / Real(4096);
        if (nearOne > 0) logarithm.Add(Log(nearOne), std::log(static_cast<long double>(nearOne)), nearOne);
    });
    ForEachMagnitude<Real>(1 - exponents, exponents, 100, [&](Real x) {
        if (x > 0) logarithm.Add(Log(x), std::log(static_cast<long double>(x)), x);
    });
    EXPECT_LT(exponential.value, 2.0) << exponential.at;
    EXPECT_LT(logarithm.value, 2.0) << logarithm.at;
}

TYPED_TEST(Trigonometry, ExponentialAndLogarithmAtTheirEnds) {
    using Real = TypeParam;
    using Limits = std::numeric_limits<Real>;
    EXPECT_EQ(Exp(Real(0)), Real(1));
    EXPECT_EQ(Exp(Real(1000)), Limits::infinity());
    EXPECT_EQ(Exp(Real(-1000)), Real(0));
    EXPECT_EQ(Exp(-Limits::infinity()), Real(0));
    EXPECT_TRUE(std::isnan(Exp(Limits::quiet_NaN())));
    EXPECT_EQ(Log(Real(1)), Real(0));
    EXPECT_EQ(Log(Real(0)), -Limits::infinity());
    EXPECT_EQ(Log(Limits::infinity()), Limits::infinity());
    EXPECT_TRUE(std::isnan(Log(Real(-1))));
    EXPECT_TRUE(std::isnan(Log(Limits::quiet_NaN())));
    EXPECT_LT(ErrorInUlps(Log(Limits::denorm_min()), std::log(static_cast<long double>(Limits::denorm_min()))), 2.0);
    EXPECT_LT(ErrorInUlps(Log(Limits::max()), std::log(static_cast<long double>(Limits::max()))), 2.0);
}

template <int N>
void ExpectLanesLikeFloat() {
    uint32_t state = 1;
    const auto random = [&] {
        state = state * 1664525u + 1013904223u;
        return static_cast<float>(state >> 8) * 0x1p-23f - 1.0f;
    };
    for (const float size : {1e-3f, 1.0f, 10.0f, 1e6f})
        for (int trial = 0; trial < 500; ++trial) {
            float a[N], b[N];
            for (int i = 0; i < N; ++i) a[i] = random() * size, b[i] = random() * size;
            const Wide<N> x = Wide<N>::Load(a), y = Wide<N>::Load(b);
            const SineCosine<Wide<N>> wide = SinCos(x);
            const Wide<N> angle = Atan2(y, x), arcCosine = Acos(x), arcSine = Asin(x);
            const Quat<Wide<N>> q = RotationFromVector<Wide<N>>(Vec3<Wide<N>>(x, y, Wide<N>(0.25f)));
            const Vec3<Wide<N>> v = RotationVectorOf(q);
            for (int i = 0; i < N; ++i) {
                EXPECT_EQ(wide.sine[i], SinCos(a[i]).sine);
                EXPECT_EQ(wide.cosine[i], SinCos(a[i]).cosine);
                EXPECT_EQ(angle[i], Atan2(b[i], a[i]));
                EXPECT_EQ(arcCosine[i], Acos(a[i]));
                EXPECT_EQ(arcSine[i], Asin(a[i]));
                const Quaternion qi = RotationFromVector(Vector3(a[i], b[i], 0.25f));
                EXPECT_EQ(q.x[i], qi.x);
                EXPECT_EQ(q.y[i], qi.y);
                EXPECT_EQ(q.z[i], qi.z);
                EXPECT_EQ(q.w[i], qi.w);
                const Vector3 vi = RotationVectorOf(qi);
                for (int k = 0; k < 3; ++k) EXPECT_EQ(v[k][i], vi[k]);
            }
        }
}

TEST(TrigonometryOfLanes, HasTheBitsOfFloat) {
    ExpectLanesLikeFloat<1>();
    ExpectLanesLikeFloat<4>();
    ExpectLanesLikeFloat<8>();
    ExpectLanesLikeFloat<16>();
}

// One value that any change of an operation, an order or a coefficient would change: the same on every machine.
TEST(TrigonometryBits, AreTheSameOnEveryMachine) {
    uint64_t hash = 0xcbf29ce484222325u;
    const auto add = [&](auto value) {
        if constexpr (sizeof(value) == 4) hash = (hash ^ std::bit_cast<uint32_t>(value)) * 0x100000001b3u;
        else hash = (hash ^ std::bit_cast<uint64_t>(value)) * 0x100000001b3u;
    };
    const auto addAll = [&](auto x) {
        using Real = decltype(x);
        const Real unit = x / (Real(1) + (x < 0 ? -x : x));
        add(SinCos(x).sine), add(SinCos(x).cosine), add(Atan2(x, Real(3))), add(Atan2(Real(-2), x));
        add(Acos(unit)), add(Asin(unit)), add(Exp(unit * 50)), add(Log(x * x));
    };
    uint32_t state = 7;
    for (int i = 0; i < 20000; ++i) {
        state = state * 1664525u + 1013904223u;
        const double x = (static_cast<double>(state) - 2147483647.5) / (i % 2 ? 4096.0 : 268435456.0);
        addAll(x);
        addAll(static_cast<float>(x));
    }
    EXPECT_EQ(hash, 2926756738957318289u);
}

TEST(RotationVector, GivesHalfTheAnglesSineAndCosine) {
    const Vector3 axis = Normalized(Vector3(1, -2, 3));
    for (const float angle : {0.0f, 1e-30f, 1e-10f, 1e-4f, 3e-4f, 4e-4f, 0.1f, 1.0f, 3.0f, 6.0f, 7.0f, 100.0f}) {
        const Quaternion q = RotationFromVector(axis * angle);
        // The vector's length is rounded before it is halved: an error of angle / 2^24 or so.
        const double tolerance = 4e-7 * (1.0 + angle);
        const double half = 0.5 * static_cast<double>(angle);
        EXPECT_NEAR(q.w, std::cos(half), tolerance) << angle;
        for (int i = 0; i < 3; ++i) EXPECT_NEAR((&q.x)[i], axis[i] * std::sin(half), tolerance) << angle;
        EXPECT_NEAR(LengthSquared(q), 1.0f, 1e-6f) << angle;
    }
}

TEST(RotationVector, ComesBackFromItsRotation) {
    for (const float angle : {0.0f, 1e-20f, 1e-6f, 3e-4f, 6e-4f, 7e-4f, 0.01f, 1.0f, 3.0f, 3.14159f}) {
        const Vector3 v = Normalized(Vector3(-3, 1, 2)) * angle;
        const Vector3 back = RotationVectorOf(RotationFromVector(v));
        // A few roundings relative to the vector's own length, however small.
        EXPECT_LE(Length(back - v), 1e-6f * angle) << angle;
    }
    EXPECT_EQ(RotationVectorOf(Quaternion{}), Vector3(0, 0, 0));
}

TEST(RotationVector, IsTheShortestOfBothDirections) {
    const Quaternion q = RotationFromVector(Vector3(0, 5, 0));  // 5 radians one way, 2 pi - 5 the other
    EXPECT_NEAR(RotationVectorOf(q).y(), 5.0 - 2.0 * std::numbers::pi, 1e-6);
    const Quaternion negated{-q.x, -q.y, -q.z, -q.w};
    EXPECT_NEAR(RotationVectorOf(negated).y(), 5.0 - 2.0 * std::numbers::pi, 1e-6);
    EXPECT_NEAR(Length(RotationVectorOf(Quaternion{1, 0, 0, 0})), std::numbers::pi, 1e-6);
}

TEST(RotationVector, NeedsNoUnitQuaternion) {
    const Quaternion q = RotationFromVector(Vector3(0.1f, 0.2f, 0.3f));
    const Quaternion scaled{q.x * 3, q.y * 3, q.z * 3, q.w * 3};
    EXPECT_LT(Length(RotationVectorOf(scaled) - Vector3(0.1f, 0.2f, 0.3f)), 1e-6f);
}

TEST(RotationVector, InDoubleHasDoublesDigits) {
    const Vec3<double> v(0.3, -0.7, 1.1);
    const Vec3<double> back = RotationVectorOf(RotationFromVector<double>(v));
    EXPECT_LT((back - v).norm(), 2e-15);
}

}  // namespace
}  // namespace fulcrum
