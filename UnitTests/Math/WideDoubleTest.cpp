#include <Fulcrum/Math/Matrix.h>
#include <Fulcrum/Math/WideDouble.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

namespace fulcrum {
namespace {

uint64_t BitsOf(double x) { return std::bit_cast<uint64_t>(x); }

// Each lane gives what double gives, to the last bit: turns of any size, and those so small that a series takes over.
TEST(WideDouble, GivesTheBitsOfDouble) {
    testing::RandomPoses random(3);
    for (int i = 0; i < 2000; ++i) {
        Position v[WideDouble::kCount];
        Vec3<WideDouble> wide;
        for (int lane = 0; lane < WideDouble::kCount; ++lane) {
            const float exponent = random.Between(-20, 8);
            const Vector3 direction = random.InCube();
            v[lane] = direction.cast<double>() * std::exp2(double{exponent});
            for (int k = 0; k < 3; ++k) wide[k].Set(lane, v[lane][k]);
        }
        const Quat<WideDouble> q = RotationFromVector<WideDouble>(wide);
        const Vec3<WideDouble> turned = ToMatrix<WideDouble>(q * q) * Rotate<WideDouble>(q, wide);
        for (int lane = 0; lane < WideDouble::kCount; ++lane) {
            const Quat<double> one = RotationFromVector<double>(v[lane]);
            const Position expected = ToMatrix<double>(one * one) * Rotate<double>(one, v[lane]);
            EXPECT_EQ(BitsOf(q.x[lane]), BitsOf(one.x));
            EXPECT_EQ(BitsOf(q.w[lane]), BitsOf(one.w));
            for (int k = 0; k < 3; ++k) EXPECT_EQ(BitsOf(turned[k][lane]), BitsOf(expected[k]));
        }
    }
}

TEST(WideDouble, ComparesAndSelectsLaneByLane) {
    WideDouble a(1.0), b(2.0);
    a.Set(2, 3.0);
    b.Set(3, 1.0);
    const WideDouble smaller = Select(a < b, a, b), larger = Select(a > b, a, b),
                     same = Select(a == b, WideDouble(1.0), WideDouble(0.0));
    for (int lane = 0; lane < WideDouble::kCount; ++lane) {
        EXPECT_EQ(smaller[lane], std::min(a[lane], b[lane]));
        EXPECT_EQ(larger[lane], std::max(a[lane], b[lane]));
        EXPECT_EQ(same[lane], lane == 3 ? 1.0 : 0.0);
        EXPECT_EQ(Abs(-a)[lane], a[lane]);
        EXPECT_EQ(Sqrt(b)[lane], std::sqrt(b[lane]));
    }
}

}  // namespace
}  // namespace fulcrum
