#include <Fulcrum/Collision/NarrowPhase/PlaneContact.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fulcrum {
namespace {

using testing::RandomPoses;

std::vector<std::shared_ptr<const ConvexShape>> Shapes() {
    RandomPoses random(1);
    std::vector<Vector3> points;
    for (int i = 0; i < 60; ++i) points.push_back(random.InBox(1));
    return {Sphere::Create(0.5f).Value(),
            Capsule::Create(0.6f, 0.3f).Value(),
            Box::Create(Vector3(0.5f, 0.75f, 1)).Value(),
            Box::Create(Vector3(0.5f, 0.75f, 1), 0.1f).Value(),
            ConvexHull::Create(points).Value(),
            ConvexHull::Create(points, {.convexRadius = 0.05f}).Value()};
}

TEST(Plane, RefusesInvalidPlanes) {
    EXPECT_EQ(Plane::Create(Vector3::Zero()).GetError().code, ErrorCode::Degenerate);
    EXPECT_EQ(Plane::Create(Vector3(0, NAN, 0)).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(Plane::Create(Vector3(0, 1, 0), INFINITY).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(Plane::Create(Vector3(0, 1, 0), 1e20f).GetError().code, ErrorCode::OutOfRange);
    EXPECT_NEAR(Length(Plane::Create(Vector3(1e-30f, 2e-30f, 0)).Value()->Normal()), 1, 1e-6);
}

TEST(Plane, IsBoundedByItsSurfaceAlone) {
    const auto floor = Plane::Create(Vector3(0, 3, 0), 2).Value();
    EXPECT_EQ(floor->LocalBounds().lower, Vector3(Vector3::Constant(-kUnboundedExtent)));
    EXPECT_EQ(floor->LocalBounds().upper, Vector3(Vector3::Constant(kUnboundedExtent)));
    EXPECT_TRUE(std::isfinite(floor->LocalBounds().HalfArea()));
    EXPECT_EQ(floor->Distance(Vector3(7, 5, 1)), 3);
}

// The deepest point is the support point, on every shape in every pose; each point lies on the plane, with the shape's
// own surface a separation above. Rounding: a few units in the last place of coordinates of up to 5 m, 1e-6 m.
TEST(PlaneContact, HasTheSupportPointAndPointsOnThePlane) {
    RandomPoses random(1);
    const CollideSettings settings;
    for (const auto& shape : Shapes()) {
        int touching = 0, several = 0;
        for (int i = 0; i < 3000; ++i) {
            const Vector3 direction = i % 3 == 0 ? Vector3(0, 1, 0) : random.InBox(1);
            const auto plane = Plane::Create(direction, random.Between(-2, 2)).Value();
            RelativePose pose{random.InBox(3), i % 2 == 0 ? random.Rotation() : Quaternion{}};
            // Near the surface: the deepest point between 10 cm below and 4 cm above it.
            const Vector3 down = InverseRotate(pose.rotation, Vector3(-plane->Normal()));
            const float lowest = plane->Distance(pose.Transform(shape->Support(down)));
            const float wanted = random.Between(-0.1f, 0.04f);
            pose.position += plane->Normal() * (wanted - lowest);

            Manifold manifold;
            CollidePlane(*plane, *shape, pose, settings, manifold);
            if (wanted > settings.speculativeDistance + 1e-5f) {
                ASSERT_EQ(manifold.pointCount, 0);
                continue;
            }
            if (wanted > settings.speculativeDistance - 1e-5f) continue;
            ++touching;
            several += manifold.pointCount > 1 ? 1 : 0;
            ASSERT_GE(manifold.pointCount, 1);
            ASSERT_LE(manifold.pointCount, 4);
            ASSERT_EQ(manifold.normal, plane->Normal());
            float deepest = 1;
            for (int k = 0; k < manifold.pointCount; ++k) {
                const ManifoldPoint& point = manifold.points[k];
                ASSERT_NEAR(plane->Distance(point.positionOnA), 0, 3e-6f);
                ASSERT_LE(point.separation, settings.speculativeDistance);
                ASSERT_NE(point.feature, 0u);
                for (int other = 0; other < k; ++other) {
                    ASSERT_NE(point.feature, manifold.points[other].feature);
                }
                deepest = std::min(deepest, point.separation);
            }
            // ChooseFour may prefer an earlier point that is as deep to within a fiftieth of the speculative distance.
            ASSERT_NEAR(deepest, wanted, 0.02f * settings.speculativeDistance + 3e-6f);
        }
        EXPECT_GT(touching, 1000);
        if (shape->Type() != ShapeType::Sphere) {
            EXPECT_GT(several, 100);
        }
    }
}

TEST(PlaneContact, ABoxRestsOnItsFourCorners) {
    const auto plane = Plane::Create().Value();
    const auto box = Box::Create(Vector3(1, 2, 3)).Value();
    Manifold manifold;
    CollidePlane(*plane, *box, {Vector3(5, 1.99f, -4), Quaternion{}}, {}, manifold);
    ASSERT_EQ(manifold.pointCount, 4);
    Vector3 sum = Vector3::Zero();
    for (const ManifoldPoint& point : manifold.points) {
        EXPECT_NEAR(point.separation, -0.01f, 1e-6f);
        EXPECT_EQ(std::fabs(point.positionOnA.x() - 5), 1);
        EXPECT_EQ(std::fabs(point.positionOnA.z() + 4), 3);
        sum += point.positionOnA;
    }
    EXPECT_NEAR(sum.x(), 20, 1e-5f);
    EXPECT_NEAR(sum.z(), -16, 1e-5f);
}

}  // namespace
}  // namespace fulcrum
