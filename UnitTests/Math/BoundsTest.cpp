#include <Fulcrum/Math/Bounds.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

TEST(Bounds, AreEmptyUntilSomethingIsIncluded) {
    Bounds bounds;
    EXPECT_TRUE(bounds.IsEmpty());
    EXPECT_FALSE(bounds.Overlaps(bounds));
    bounds.Include(Vector3(1, 2, 3));
    EXPECT_FALSE(bounds.IsEmpty());
    EXPECT_EQ(bounds.Center(), Vector3(1, 2, 3));
    EXPECT_EQ(bounds.HalfExtents(), Vector3(0, 0, 0));
}

TEST(Bounds, GrowToWhatTheyInclude) {
    Bounds bounds;
    bounds.Include(Vector3(1, -2, 3));
    bounds.Include(Vector3(-1, 2, 5));
    EXPECT_EQ(bounds.Center(), Vector3(0, 0, 4));
    EXPECT_EQ(bounds.HalfExtents(), Vector3(1, 2, 1));
    EXPECT_EQ(bounds.HalfArea(), 2.0f * 4.0f + 4.0f * 2.0f + 2.0f * 2.0f);
    Bounds other;
    other.Include(Vector3(9, 0, 0));
    other.Include(bounds);
    EXPECT_TRUE(other.Contains(bounds));
    EXPECT_FALSE(bounds.Contains(other));
}

TEST(Bounds, OverlapWhereTheyTouch) {
    const Bounds a{Vector3(0, 0, 0), Vector3(1, 1, 1)};
    EXPECT_TRUE(a.Overlaps({Vector3(1, 1, 1), Vector3(2, 2, 2)}));
    for (int axis = 0; axis < 3; ++axis) {
        Bounds apart = a;
        apart.lower[axis] += 1.5f;
        apart.upper[axis] += 1.5f;
        EXPECT_FALSE(a.Overlaps(apart));
        EXPECT_FALSE(apart.Overlaps(a));
    }
}

TEST(Bounds, RoundOutwards) {
    for (const double x : {0.1, -0.1, 1e7 + 0.3, -1e7 - 0.3, 1e12 + 1.0, -1e-50, 1e-50, 0.0, 0.5}) {
        EXPECT_LE(static_cast<double>(RoundDown(x)), x);
        EXPECT_GE(static_cast<double>(RoundUp(x)), x);
        // By no more than the gap between floats, which is empty where x is a float.
        EXPECT_LE(RoundUp(x), std::nextafterf(RoundDown(x), std::numeric_limits<float>::infinity()));
    }
    EXPECT_EQ(RoundDown(0.5), RoundUp(0.5));
    const Bounds b = RoundedOutwards(Position(0.1, 0.2, 0.3), Position(0.4, 0.6, 0.7));
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(static_cast<double>(b.lower[axis]), Position(0.1, 0.2, 0.3)[axis]);
        EXPECT_GE(static_cast<double>(b.upper[axis]), Position(0.4, 0.6, 0.7)[axis]);
    }
}

}  // namespace
}  // namespace fulcrum
