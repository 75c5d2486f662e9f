// Manifolds in closed form: how many points, where, and under which names.
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace fulcrum::testing {
namespace {

std::set<uint32_t> Features(const Manifold& manifold) {
    std::set<uint32_t> features;
    for (int i = 0; i < manifold.pointCount; ++i) features.insert(manifold.points[i].feature);
    return features;
}

bool HasPointNear(const Manifold& manifold, const Vector3& expected, float tolerance) {
    for (int i = 0; i < manifold.pointCount; ++i)
        if (Length(Vector3(manifold.points[i].positionOnA - expected)) <= tolerance) return true;
    return false;
}

// Sides are clipped where the other face ends, to within 2 % of the speculative distance; aligned ones lie a rounding
// off.
constexpr float kClipSlop = 1.5f * 0.02f * 0.02f;

// A turn about y, rad.
Quaternion AboutY(float angle) { return {0, std::sin(angle / 2), 0, std::cos(angle / 2)}; }

// The same box as itself and as a hull: the two functions must agree.
class FlatBoxes : public ::testing::TestWithParam<bool> {
protected:
    ConvexPtr MakeCuboid(const Vector3& half) const {
        if (!GetParam()) return MakeBox(half);
        std::vector<Vector3> corners;
        for (int i = 0; i < 8; ++i)
            corners.push_back(
                Vector3(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(), i & 4 ? half.z() : -half.z()));
        return MakeHull(corners);
    }
};
INSTANTIATE_TEST_SUITE_P(BoxAndHull, FlatBoxes, ::testing::Bool());

TEST_P(FlatBoxes, StackedSquarelyTouchInFourCorners) {
    const ConvexPtr box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    const Manifold m = CollideCold(box, box, {Vector3(0, 0.995f, 0), {}});
    ASSERT_EQ(m.pointCount, 4);
    EXPECT_EQ(m.normal, Vector3(0, 1, 0));
    for (float x : {-0.5f, 0.5f})
        for (float z : {-0.5f, 0.5f}) EXPECT_TRUE(HasPointNear(m, Vector3(x, 0.5f, z), 1e-6f));
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(m.points[i].separation, -0.005f, 1e-6f);
    EXPECT_EQ(Features(m).size(), 4u);
}

// A prism of twelve sides that stands on a bottom edge, tilted by 0.03 rad: both ends of the edge touch, all other
// corners are at least 4 mm above the floor. The largest area would leave out one end, and the prism would rock about
// the other.
TEST(TiltedPrism, TouchesAtBothEndsOfTheEdgeThatItStandsOn) {
    constexpr int kSides = 12;
    constexpr float kTilt = 0.03f;
    std::vector<Vector3> corners;
    for (int i = 0; i < kSides; ++i)
        for (const float y : {-0.2f, 0.2f}) {
            const float angle = (static_cast<float>(i) + 0.5f) * 6.28318531f / kSides;
            corners.push_back(Vector3(0.5f * std::cos(angle), y, 0.5f * std::sin(angle)));
        }
    const ConvexPtr prism = MakeHull(corners), floor = MakeBox(Vector3(2, 1, 2));
    const Quaternion tilt{std::sin(kTilt / 2), 0, 0, std::cos(kTilt / 2)};
    float lowest = 0;
    for (const Vector3& corner : corners) lowest = std::min(lowest, Rotate(tilt, corner).y());
    const Manifold m = CollideCold(floor, prism, {Vector3(0, 1 - lowest, 0), tilt});
    ASSERT_EQ(m.pointCount, 4);
    int touching = 0;
    for (int i = 0; i < m.pointCount; ++i) touching += m.points[i].separation < 1e-4f;
    EXPECT_EQ(touching, 2);
}

TEST_P(FlatBoxes, OffsetTouchAtTheCornersOfTheOverlap) {
    const ConvexPtr box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    const Manifold m = CollideCold(box, box, {Vector3(0.3f, 1.01f, -0.2f), {}});
    ASSERT_EQ(m.pointCount, 4);
    for (float x : {-0.2f, 0.5f})
        for (float z : {-0.5f, 0.3f}) EXPECT_TRUE(HasPointNear(m, Vector3(x, 0.5f, z), kClipSlop));
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(m.points[i].separation, 0.01f, 1e-6f);
}

TEST_P(FlatBoxes, SmallOnLargeTouchInTheSmallOnesCorners) {
    const ConvexPtr floor = MakeCuboid(Vector3(50, 1, 50)), box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    const Manifold m = CollideCold(floor, box, {Vector3(10, 1.5f, 20), {}});
    ASSERT_EQ(m.pointCount, 4);
    for (float x : {9.5f, 10.5f})
        for (float z : {19.5f, 20.5f}) EXPECT_TRUE(HasPointNear(m, Vector3(x, 1, z), 2e-5f));
}

// Turned by 45 degrees the overlap of two unit squares is a regular octagon with inner radius 1/2 and area
// 2 (sqrt 2 - 1) = 0.828. Four of its corners span at least the square on every other one: with the outer radius
// R^2 = 1/4 + (tan 22.5 deg / 2)^2 = 0.2929 that is 2 R^2 = 0.586. The deepest-first choice may take a farthest point
// one corner off.
TEST_P(FlatBoxes, CrossedKeepMostOfTheArea) {
    const ConvexPtr box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    const Manifold m = CollideCold(box, box, {Vector3(0, 0.995f, 0), AboutY(0.785398163f)});
    ASSERT_EQ(m.pointCount, 4);
    std::array<Vector3, 4> p;
    for (int i = 0; i < 4; ++i) p[static_cast<size_t>(i)] = m.points[i].positionOnA;
    std::sort(p.begin(), p.end(),
              [](const Vector3& a, const Vector3& b) { return std::atan2(a.x(), a.z()) < std::atan2(b.x(), b.z()); });
    float area = 0;
    for (size_t i = 0; i < 4; ++i) area += 0.5f * Cross<float>(p[i], p[(i + 1) % 4]).y();
    EXPECT_GT(std::abs(area), 0.5f);
    for (const Vector3& x : p)
        EXPECT_LE(std::abs(x.x()) + std::abs(x.z()), std::sqrt(0.5f) + 1e-3f);  // inside the turned one
}

TEST_P(FlatBoxes, FeaturesAndPointsPersistUnderTinyMotion) {
    const ConvexPtr box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    RandomPoses random(9);
    for (const Vector3& offset : {Vector3(0, 0.997f, 0), Vector3(0.25f, 0.997f, 0), Vector3(0.25f, 0.997f, 0.1f)}) {
        PairCache cache;
        const Manifold first = CollideOnce(box, box, {offset, {}}, cache);
        for (int i = 0; i < 200; ++i) {
            const RelativePose pose{
                offset + 1e-5f * random.InCube(),
                Normalized(Quaternion{1e-5f * random.Between(-1, 1), 1e-5f * random.Between(-1, 1), 0, 1})};
            const Manifold m = CollideOnce(box, box, pose, cache);
            EXPECT_EQ(Features(m), Features(first));
        }
    }
}

TEST_P(FlatBoxes, TippedOnAnEdgeTouchInTwoPoints) {
    const ConvexPtr floor = MakeCuboid(Vector3(50, 1, 50)), box = MakeCuboid(Vector3(0.5f, 0.5f, 0.5f));
    const float angle = 0.5f, reach = 0.5f * (std::sin(angle) + std::cos(angle));
    const Quaternion tipped{std::sin(angle / 2), 0, 0, std::cos(angle / 2)};
    const Manifold m = CollideCold(floor, box, {Vector3(0, 1 + reach - 0.001f, 0), tipped});
    ASSERT_EQ(m.pointCount, 2);
    EXPECT_EQ(m.normal, Vector3(0, 1, 0));
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, -0.001f, 1e-6f);
}

TEST(Manifold, EdgesCrossInOnePoint) {
    const ConvexPtr box = MakeBox(Vector3(0.5f, 0.5f, 0.5f));
    // A stands on its edge along x, B hangs over it on its edge along z.
    const float h = std::sqrt(0.5f), s = std::sin(0.3926991f), c = std::cos(0.3926991f);
    const Quaternion a{s, 0, 0, c}, b{0, 0, s, c};
    const RelativePose pose{InverseRotate(a, Vector3(0, 2 * h - 0.01f, 0)), a.Conjugate() * b};
    PairCache cache;
    for (int step = 0; step < 2; ++step) {
        const Manifold m = CollideOnce(box, box, pose, cache);
        ASSERT_EQ(m.pointCount, 1);
        EXPECT_NEAR(m.points[0].separation, -0.01f, 1e-6f);
        EXPECT_NEAR(Dot(Rotate(a, m.normal), Vector3(0, 1, 0)), 1, 1e-6f);
        EXPECT_LT(Length(Vector3(Rotate(a, m.points[0].positionOnA) - Vector3(0, h, 0))), 1e-6f);
    }
}

// Two cubes of side 1, gap 0.01, corner over corner along the diagonal: the distance is that of the corners, along the
// diagonal.
TEST(Manifold, SeparatedCornersHaveASpeculativePoint) {
    const ConvexPtr box = MakeBox(Vector3(0.5f, 0.5f, 0.5f));
    const float gap = 0.01f;
    const Vector3 diagonal = Vector3::Constant(1 / std::sqrt(3.0f));
    const Manifold m = CollideCold(box, box, {Vector3::Ones() + diagonal * gap, {}});
    ASSERT_GE(m.pointCount, 1);  // the corners, and where the faces follow
    EXPECT_NEAR(m.points[0].separation, gap, 1e-6f);
    EXPECT_GT(Dot(m.normal, diagonal), 0.9999f);
}

TEST(Manifold, ParallelCapsulesTouchInTwoPoints) {
    const ConvexPtr capsule = MakeCapsule(0.5f, 0.2f);
    const Manifold m = CollideCold(capsule, capsule, {Vector3(0.39f, 0.25f, 0), {}});
    ASSERT_EQ(m.pointCount, 2);
    EXPECT_NEAR(Length(Vector3(m.normal - Vector3(1, 0, 0))), 0, 1e-6f);
    EXPECT_TRUE(HasPointNear(m, Vector3(0.2f, -0.25f, 0), 1e-6f));
    EXPECT_TRUE(HasPointNear(m, Vector3(0.2f, 0.5f, 0), 1e-6f));
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[i].separation, -0.01f, 1e-6f);
}

TEST(Manifold, CrossingCapsulesSeparateAlongTheCrossProduct) {
    const ConvexPtr capsule = MakeCapsule(0.5f, 0.2f);
    const float h = std::sqrt(0.5f);
    for (const float offset : {0.0f, 1e-9f, 1e-4f, -0.1f}) {
        const Manifold m = CollideCold(capsule, capsule, {Vector3(0, 0, offset), {0, 0, h, h}});
        ASSERT_EQ(m.pointCount, 1);
        EXPECT_NEAR(std::abs(m.normal.z()), 1, 1e-5f);
        EXPECT_NEAR(m.points[0].separation, -0.4f + std::abs(offset), 1e-6f);
    }
}

TEST(Manifold, CapsuleLyingOnABoxTouchesInTwoPoints) {
    const ConvexPtr box = MakeBox(Vector3(2, 1, 2)), capsule = MakeCapsule(0.5f, 0.2f);
    const float h = std::sqrt(0.5f);
    const Manifold m = CollideCold(box, capsule, {Vector3(0.3f, 1.199f, 0), {0, 0, h, h}});
    ASSERT_EQ(m.pointCount, 2);
    EXPECT_EQ(m.normal, Vector3(0, 1, 0));
    EXPECT_TRUE(HasPointNear(m, Vector3(0.8f, 1, 0), 1e-6f));
    EXPECT_TRUE(HasPointNear(m, Vector3(-0.2f, 1, 0), 1e-6f));
}

// Concentric, contained, needle and flake: always a unit normal, and moving B out by the depth parts them.
TEST(Manifold, DegenerateOverlapsHaveANormal) {
    const std::vector<NamedShape> shapes = {{"sphere", MakeSphere(0.5f)},
                                            {"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
                                            {"needle", MakeBox(Vector3(0.001f, 2, 0.001f))},
                                            {"flake", MakeBox(Vector3(1, 0.0005f, 1))},
                                            {"rounded", MakeBox(Vector3(0.5f, 0.4f, 0.7f), 0.4f)},
                                            {"capsule", MakeCapsule(0.5f, 0.25f)},
                                            {"hull", MakeRoundHull(32, 0.6f)},
                                            {"big hull", MakeRoundHull(250, 3)},
                                            {"prism", MakePrism(8, 0.5f, 0.4f)}};
    RandomPoses random(1);
    for (const NamedShape& a : shapes) {
        for (const NamedShape& b : shapes) {
            for (int i = 0; i < 40; ++i) {
                RelativePose pose;
                if (i % 2 == 1) pose.rotation = i % 4 == 1 ? random.QuarterTurns() : random.Rotation();
                if (i >= 20) pose.position = 0.05f * random.InCube();
                const Manifold m = CollideCold(a.shape, b.shape, pose);
                if (i < 20) {
                    ASSERT_GE(m.pointCount, 1) << a.name << " " << b.name << " " << i;
                }
                if (m.pointCount == 0) continue;
                ASSERT_NEAR(Length(m.normal), 1, 1e-5f) << a.name << " " << b.name << " " << i;
                for (int k = 0; k < m.pointCount; ++k) {
                    ASSERT_TRUE(IsFinite(m.points[k].positionOnA) && std::isfinite(m.points[k].separation))
                        << a.name << " " << b.name << " " << i;
                    ASSERT_NE(m.points[k].feature, 0u);
                }
                pose.position += m.normal * (1e-5f - DeepestSeparation(m));
                EXPECT_GT(SeparationAlong(*a.shape, *b.shape, pose, m.normal), -1e-3)
                    << a.name << " " << b.name << " " << i;
            }
        }
    }
}

TEST(Manifold, FeaturesOfHullsPersistUnderTinyMotion) {
    const ConvexPtr hull = MakeRoundHull(32, 0.6f);
    RandomPoses random(4);
    int changed = 0, found = 0;
    for (int i = 0; i < 1000; ++i) {
        RelativePose pose{random.Direction(), random.Rotation()};
        pose.position *=
            static_cast<float>(-SeparationAlong(*hull, *hull, {Vector3::Zero(), pose.rotation}, pose.position)) - 0.05f;
        PairCache cache;
        const Manifold first = CollideOnce(hull, hull, pose, cache);
        pose.position += 1e-6f * random.InCube();
        const Manifold second = CollideOnce(hull, hull, pose, cache);
        if (first.pointCount == 0) continue;
        ++found;
        if (Features(first) != Features(second)) ++changed;
    }
    EXPECT_GT(found, 300);
    // A motion of 1e-6 m crosses the border of a feature (some cm wide) or the speculative distance about once in 10^4.
    EXPECT_LE(changed, 2);
}

TEST(ManifoldReduction, TakesTheDeepestAndTheCornersOfASquare) {
    FlatPoints<16> points;
    points.Add(0, 0, -0.1f);  // the deepest, in the middle
    for (const float u : {-1.0f, -0.5f, 0.5f, 1.0f}) points.Add(u, 0, 0);
    for (const float v : {-1.0f, -0.5f, 0.5f, 1.0f}) points.Add(0, v, 0);
    int chosen[4];
    ASSERT_EQ(ChooseFour(points, 1e-4f, chosen), 4);
    EXPECT_EQ(chosen[0], 0);
    EXPECT_EQ(chosen[1], 1);  // (-1, 0)
    EXPECT_EQ(chosen[2], 5);  // (0, -1)
    EXPECT_EQ(chosen[3], 8);  // (0, 1)
}

TEST(ManifoldReduction, OfPointsInOnePlaceTakesOne) {
    FlatPoints<16> points;
    for (int i = 0; i < 9; ++i) points.Add(2, 3, -0.01f);
    int chosen[4];
    EXPECT_EQ(ChooseFour(points, 1e-4f, chosen), 1);
}

// Two cylinders that lie across each other at a small angle touch in one point. If they move far within the step, the
// ends beside it count, too: an end at l from the other's edge has what lies between the circles of their sides there.
TEST(EndsAhead, OfNearlyParallelCylindersArePointsWithinReach) {
    const float radius = 0.3f, half = 1, angle = 0.1f, gap = 0.01f;
    const ConvexPtr cylinder = Cylinder::Create(half, radius).Value();
    // Both along y in their own frames, B beside A in x and turned about x.
    const RelativePose pose{Vector3(2 * radius + gap, 0, 0), {std::sin(angle / 2), 0, 0, std::cos(angle / 2)}};
    const Manifold near = CollideCold(cylinder, cylinder, pose, {.speculativeDistance = 0.02f});
    ASSERT_EQ(near.pointCount, 1);
    const Manifold fast = CollideCold(cylinder, cylinder, pose, {.speculativeDistance = 0.2f});
    ASSERT_GT(fast.pointCount, 2);
    const float beside = half * std::sin(angle);
    const float separation = gap + radius - std::sqrt(radius * radius - beside * beside);
    int ends = 0;
    for (int i = 0; i < fast.pointCount; ++i) {
        const ManifoldPoint& point = fast.points[i];
        if (std::fabs(point.positionOnA.y()) < 0.5f * half) continue;
        ++ends;
        EXPECT_NEAR(point.separation, separation, 1e-3f);
        EXPECT_NEAR(std::fabs(point.positionOnA.y()), half, 0.01f);
    }
    EXPECT_GE(ends, 2);
    EXPECT_EQ(Features(fast).size(), static_cast<size_t>(fast.pointCount));
}

}  // namespace
}  // namespace fulcrum::testing
