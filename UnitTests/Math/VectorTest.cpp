#include <Fulcrum/Math/Vector.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

TEST(Vector, ProductsFollowTheRightHandRule) {
    EXPECT_EQ(Cross<float>(Vector3::UnitX(), Vector3::UnitY()), Vector3(0, 0, 1));
    EXPECT_EQ(Cross<float>(Vector3::UnitY(), Vector3::UnitZ()), Vector3(1, 0, 0));
    EXPECT_EQ(Dot<float>(Vector3(1, 2, 3), Vector3(4, -5, 6)), 12.0f);
    EXPECT_EQ(Length(Vector3(2, 3, 6)), 7.0f);
}

TEST(Vector, NormalizesOrFallsBack) {
    EXPECT_EQ(Normalized(Vector3(0, 0, -5)), Vector3(0, 0, -1));
    EXPECT_EQ(Normalized(Vector3(0, 0, 0)), Vector3(0, 1, 0));
    EXPECT_EQ(Normalized(Vector3(1e-13f, 0, 0), Vector3(1, 0, 0)), Vector3(1, 0, 0));
}

TEST(Vector, PerpendicularIsAUnitVectorAtARightAngle) {
    for (int i = 0; i < 1000; ++i) {
        // Points of a spiral over the sphere, both poles among them.
        const float z = -1.0f + 2.0f * static_cast<float>(i) / 999.0f;
        const float radius = std::sqrt(std::max(0.0f, 1.0f - z * z)), turn = 2.4f * static_cast<float>(i);
        const Vector3 n = Normalized(Vector3(radius * std::cos(turn), radius * std::sin(turn), z));
        const Vector3 p = Perpendicular(n);
        EXPECT_NEAR(Dot(n, p), 0.0f, 1e-6f);
        EXPECT_NEAR(Length(p), 1.0f, 1e-6f);
    }
}

TEST(Vector, KnowsWhatIsFinite) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(IsFinite(Vector3(1, 2, 3)));
    for (int axis = 0; axis < 3; ++axis)
        for (const float bad : {infinity, -infinity, nan}) {
            Vector3 v(1, 2, 3);
            v[axis] = bad;
            EXPECT_FALSE(IsFinite(v));
            EXPECT_FALSE(IsFinite(Position(v.cast<double>())));
        }
}

}  // namespace
}  // namespace fulcrum
