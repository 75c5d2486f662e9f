// Small bodies on a ground of kilometers, in its middle above all, where the two triangles that it is made of meet and
// the simplices of GJK become as flat as a hundred thousandth: contacts and queries found nothing there, and bodies
// fell through.
#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

namespace fulcrum::testing {
namespace {

struct Case {
    const char* name;
    std::shared_ptr<const ConvexShape> shape;
};

std::vector<Case> SmallShapes() {
    RandomPoses random(7);
    std::vector<Vector3> points;
    for (int i = 0; i < 16; ++i) points.push_back(random.InBox(0.5f));
    return {{"sphere", Sphere::Create(0.3f).Value()},
            {"capsule", Capsule::Create(0.5f, 0.1f).Value()},
            {"box", Box::Create({0.5f, 0.3f, 0.2f}).Value()},
            {"hull", ConvexHull::Create(points).Value()},
            {"cylinder", Cylinder::Create(0.5f, 0.2f).Value()}};
}

std::shared_ptr<const ConvexShape> SlabOf(float half, bool isHull) {
    if (!isHull) return Box::Create({half, 1, half}).Value();
    std::vector<Vector3> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back(Vector3(i & 1 ? half : -half, i & 2 ? 1.0f : -1.0f, i & 4 ? half : -half));
    return ConvexHull::Create(corners).Value();
}

// A slab, 1 m thick from its center, in the frame of a shape whose lowest point is `gap` m above its top.
RelativePose SlabBelow(const ConvexShape& shape, const Quaternion& rotation, float x, float z, float gap) {
    const Vector3 lowest = Rotate(rotation, shape.Support(InverseRotate(rotation, Vector3(0, -1, 0))));
    const Vector3 center(x, 1 + gap - lowest.y(), z);
    return Inverse(RelativePose{center, rotation});
}

class LargeGround : public ::testing::TestWithParam<float> {};
INSTANTIATE_TEST_SUITE_P(OfHalf, LargeGround, ::testing::Values(50.0f, 200.0f, 1000.0f, 3000.0f, 10000.0f));

// What positions of floats leave open, m, this far from the center of the ground.
float Rounding(float far) { return 1e-5f + 2e-6f * far; }

TEST_P(LargeGround, IsTouchedByWhatIsNearIt) {
    const float half = GetParam();
    CollideSettings settings;
    settings.speculativeDistance = 0.1f;
    for (const Case& small : SmallShapes())
        for (const bool isHull : {false, true}) {
            // Hulls of 3 km and more may miss one of thousands.
            if (isHull && half > 1000) continue;
            SCOPED_TRACE(std::string(small.name) + (isHull ? " on a hull" : " on a box"));
            const std::shared_ptr<const ConvexShape> slab = SlabOf(half, isHull);
            RandomPoses random(11);
            for (int i = 0; i < Cases(1500); ++i) {
                const float span = i % 3 == 0 ? 0.9f * half : 2;
                const bool isCenter = i % 3 == 1;
                const float x = isCenter ? 0 : random.Between(-span, span),
                            z = isCenter ? 0 : random.Between(-span, span);
                const float gap = random.Between(-0.04f, 0.04f);
                const Quaternion rotation = random.Rotation();
                const RelativePose slabInShape = SlabBelow(*small.shape, rotation, x, z, gap);
                PairCache cache;
                Manifold manifold;
                CollideCounters counters;
                Collide(*small.shape, *slab, slabInShape, settings, cache, manifold, counters);
                ASSERT_GT(manifold.pointCount, 0) << i;
                ASSERT_LT(Rotate(rotation, manifold.normal).y(), -0.999f) << i;
                float least = manifold.points[0].separation;
                for (int k = 1; k < manifold.pointCount; ++k) least = std::min(least, manifold.points[k].separation);
                // A face is preferred to the least depth by a fiftieth of the speculative distance at most.
                ASSERT_NEAR(least, gap, 0.02f * settings.speculativeDistance + Rounding(std::abs(x) + std::abs(z)))
                    << i;
            }
        }
}

TEST_P(LargeGround, IsMeasuredExactly) {
    const float half = GetParam();
    for (const Case& small : SmallShapes()) {
        SCOPED_TRACE(small.name);
        const std::shared_ptr<const ConvexShape> slab = SlabOf(half, false);
        RandomPoses random(13);
        for (int i = 0; i < Cases(1000); ++i) {
            const float span = i % 2 == 0 ? 0.9f * half : 2;
            const float x = random.Between(-span, span), z = random.Between(-span, span);
            const float gap = random.Between(-0.3f, 0.3f);
            const RelativePose slabInShape = SlabBelow(*small.shape, random.Rotation(), x, z, gap);
            // Queries turn the ground's corners into the shape's frame.
            const float error = Rounding(std::abs(x) + std::abs(z)) + 3e-7f * half;
            ClosestPoints closest;
            ASSERT_TRUE(FindClosestPoints(*small.shape, *slab, slabInShape, 1, closest)) << i;
            // EPA ends within 3e-5 of the shapes' distance, at most 32 radii of the small one.
            const float tolerance = 3e-5f * std::min(std::abs(x) + std::abs(z) + 2, 32 * small.shape->OuterRadius());
            ASSERT_NEAR(closest.distance, gap, error + tolerance) << i;
            if (std::abs(gap) > error) {
                ASSERT_EQ(Overlap(*small.shape, *slab, slabInShape), gap < 0) << i << ": " << gap;
            }
        }
    }
}

TEST(LargeGroundInAWorld, CarriesACapsuleAboveItsCenter) {
    for (int turn = 0; turn < 32; ++turn) {
        SCOPED_TRACE(turn);
        const std::unique_ptr<PhysicsSystem> world = PhysicsSystem::Create().Value();
        BodyInterface& bodies = world->Bodies();
        bodies.Create({.shape = SlabOf(3000, false), .motion = MotionType::Static, .position = {0, -1, 0}}).Value();
        RandomPoses random(100 + static_cast<uint32_t>(turn));
        const BodyId capsule = bodies
                                   .Create({.shape = Capsule::Create(0.5f, 0.1f).Value(),
                                            .position = {0, 0.8, 0},
                                            .rotation = random.Rotation(),
                                            .angularVelocity = random.InBox(10)})
                                   .Value();
        for (int step = 0; step < 240; ++step) ASSERT_TRUE(world->Update(1.0 / 60));
        EXPECT_NEAR(bodies.GetPose(capsule).position.y(), 0.1, 0.005);
    }
}

}  // namespace
}  // namespace fulcrum::testing
