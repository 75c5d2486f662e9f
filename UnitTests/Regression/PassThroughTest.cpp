// Boxes passed through each other: a body had no contact with another that moved along with it until something stopped
// one of the two; two crossing edges had a single point, about which the boxes rotated into each other; and a soft
// contact under a heavy load yielded faster than its push, whose speed is limited, could recover.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Samples/Scenes/PenetrationMeter.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <vector>
#include <cmath>
#include <limits>

namespace fulcrum::testing {
namespace {

constexpr float kHalf = 0.2f;  // m, of the cubes

// m, by the shapes alone.
float DepthOf(TestWorld& world, BodyId a, BodyId b) {
    const auto center = [&](BodyId id) {
        return Pose{world.Bodies().GetCenterOfMass(id), world.Bodies().GetPose(id).rotation};
    };
    ClosestPoints closest;
    const bool overlap = FindClosestPoints(*world.Bodies().GetShape(a), *world.Bodies().GetShape(b),
                                           Relative(center(a), center(b)), 0, closest);
    return overlap ? -closest.distance : 0.0f;
}

TEST(PassThrough, BodiesThatFallTogetherHaveContactsWhenTheGroundStopsTheFirst) {
    for (const double gap : {0.03, 0.06, 0.1, 0.15, 0.2, 0.25}) {
        TestWorld world;
        world.AddFloor();
        const BodyId lower =
            world.Add({.shape = CubeOf(kHalf), .position = {0, 0.25, 0}, .linearVelocity = {0, -16, 0}});
        const BodyId upper =
            world.Add({.shape = CubeOf(kHalf), .position = {0.03, 0.65 + gap, 0.02}, .linearVelocity = {0, -16, 0}});
        float deepest = 0;
        for (int step = 0; step < 30; ++step) {
            world.Step();
            deepest = std::max(deepest, DepthOf(world, lower, upper));
        }
        EXPECT_LT(deepest, 0.25f * kHalf) << "gap " << gap;
    }
}

// The end of an arm of 5 m that turns at 20 rad/s moves by 1.7 m a step, while its center rests. Bodies in its way are
// hit, and leave with at least half the speed of the point that hit them.
TEST(PassThrough, AFastRotatingBodyHitsBodiesInItsWay) {
    constexpr float kArm = 5, kSpin = 20;  // m, rad/s
    const Vector3 corners[] = {{0, 0, -1}, {kArm + 0.5f, 0, -1}, {kArm + 0.5f, 0, 1}, {0, 0, 1}};
    const uint32_t indices[] = {0, 2, 1, 0, 3, 2};
    const ShapePtr paddles = CompoundOf({{.shape = CubeOf(0.25f), .position = {kArm, 0, 0}},
                                         {.shape = CubeOf(0.25f), .position = {-kArm, 0, 0}}}),
                   rod = BoxOf(kArm + 0.25f, 0.25f, 0.25f);
    const struct {
        const char* what;
        ShapePtr shape;
        MotionType motion;
    } turning[] = {
        {"paddles, kinematic", paddles, MotionType::Kinematic},
        {"paddles", paddles, MotionType::Dynamic},
        {"rod, kinematic", rod, MotionType::Kinematic},
        {"rod", rod, MotionType::Dynamic},
        {"blade of triangles", TriangleMesh::Create({.vertices = corners, .indices = indices}).Value(),
         MotionType::Kinematic},
    };
    for (const auto& t : turning)
        for (const ShapePtr& shape : {CubeOf(0.25f), SphereOf(0.25f), CapsuleOf(0.2f, 0.2f), CubeOf(0.05f)})
            for (const double steps : {0.35, 0.5, 0.65, 1.5, 2.4}) {
                TestWorld world(NoGravity());
                world.Add({.shape = t.shape, .motion = t.motion, .angularVelocity = {0, 0, kSpin}, .mass = 1e5f});
                const double angle = steps * kSpin * kStep;
                const Vector3 outwards(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0),
                    along(-outwards.y(), outwards.x(), 0);
                const BodyId target = world.Add({.shape = shape,
                                                 .position = (outwards * kArm).cast<double>(),
                                                 .rotation = RotationAbout(Vector3(0, 0, 1), angle)});
                world.Steps(4);
                EXPECT_GT(Dot(world.VelocityOf(target), along), 0.5f * kSpin * kArm)
                    << t.what << " and " << shape->OuterRadius() << " m, after " << steps << " steps";
            }
}

TEST(PassThrough, EdgesThatMeetDoNotTurnTheFacesIntoEachOther) {
    float deepest = 0;
    for (uint32_t seed = 1; seed <= 200; ++seed) {
        RandomPoses random(seed);
        TestWorld world(NoGravity());
        const BodyId a = world.Add({.shape = CubeOf(kHalf), .position = {0, 0, 0}, .rotation = random.Rotation()});
        const BodyId b = world.Add({.shape = CubeOf(kHalf),
                                    .position = {0.15, 0.9, -0.1},
                                    .rotation = random.Rotation(),
                                    .linearVelocity = {0, -10, 0}});
        for (int step = 0; step < 20; ++step) {
            world.Step();
            deepest = std::max(deepest, DepthOf(world, a, b));
        }
    }
    EXPECT_LT(deepest, 0.5f * kHalf);
}

// With the closest points of edges alone pyramids were on average 0.14 of their inner radius inside each other, once
// more than all of it.
TEST(PassThrough, EdgesOfOtherShapesThatMeetDoNotTurnTheFacesIntoEachOther) {
    const Vector3 corners[] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
    const ShapePtr pyramid = ConvexHull::Create(corners).Value(), cylinder = Cylinder::Create(0.2f, 0.5f).Value();
    const ShapePtr capsule = Capsule::Create(0.75f, 0.5f).Value(), box = Box::Create({0.5f, 0.3f, 0.5f}).Value();
    const struct {
        const char* what;
        ShapePtr a, b;
        double most, mean;  // of the smaller inner radius
    } pairs[] = {
        {"pyramids", pyramid, pyramid, 0.3, 0.03},       {"pyramid and capsule", pyramid, capsule, 0.65, 0.06},
        {"pyramid and box", pyramid, box, 0.3, 0.03},    {"cylinders", cylinder, cylinder, 0.5, 0.06},
        {"cylinder and box", cylinder, box, 0.35, 0.04}, {"cylinder and capsule", cylinder, capsule, 0.32, 0.04}};
    constexpr int kSeeds = 200;
    for (const auto& pair : pairs) {
        double deepest = 0, sum = 0;
        for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
            RandomPoses random(seed);
            TestWorld world(NoGravity());
            const BodyId a = world.Add({.shape = pair.a, .position = {0, 0, 0}, .rotation = random.Rotation()});
            const BodyId b = world.Add({.shape = pair.b,
                                        .position = {0.15, 2.5, -0.1},
                                        .rotation = random.Rotation(),
                                        .linearVelocity = {0, -10, 0}});
            double worst = 0;
            for (int step = 0; step < 30; ++step) {
                world.Step();
                worst = std::max(worst, double{DepthOf(world, a, b)});
            }
            deepest = std::max(deepest, worst);
            sum += worst;
        }
        const double inner = double{std::min(pair.a->InnerRadius(), pair.b->InnerRadius())};
        EXPECT_LT(deepest / inner, pair.most) << pair.what;
        EXPECT_LT(sum / kSeeds / inner, pair.mean) << pair.what;
    }
}

// Cubes meet at 30 m/s there, half a meter a step: which two meet worst is chance. The median of three runs whose time
// steps differ by 1e-4.
TEST(PassThrough, CubesOfTheDrumKeepTheirDistance) {
    std::vector<double> worst;
    for (const double dt : {0.016666, 0.016667, 0.016668}) {
        Result<std::unique_ptr<SceneWorld>> drum = SceneWorld::Create(*FindScene("drum"));
        ASSERT_TRUE(drum);
        PenetrationMeter meter(*drum.Value());
        for (int step = 0; step < 120; ++step) {
            ASSERT_TRUE(drum.Value()->Step(dt));
            meter.Measure();
        }
        worst.push_back(meter.Worst().relative);
    }
    std::ranges::sort(worst);
    EXPECT_LT(worst[1], 0.65);
}

// Over the smaller inner radius, of all steps.
double WorstPenetration(const char* scene, int steps) {
    Result<std::unique_ptr<SceneWorld>> world = SceneWorld::Create(*FindScene(scene));
    EXPECT_TRUE(world);
    if (!world) return std::numeric_limits<double>::infinity();
    PenetrationMeter meter(*world.Value());
    for (int step = 0; step < steps; ++step) {
        EXPECT_TRUE(world.Value()->Step(kStep));
        meter.Measure();
    }
    return meter.Worst().relative;
}

// Rods and boxes meet at up to 500 m/s, and turn by up to 5 rad a step: 125,000 hits, of which 20 leave more than 0.1.
TEST(PassThrough, BodiesOfHighSpeedDoNotEnterEachOther) { EXPECT_LT(WorstPenetration("high_speed", 200), 0.3); }

TEST(PassThrough, AStackThatFallsIsNotSquashed) { EXPECT_LT(WorstPenetration("trap_door", 360), 0.1); }

TEST(PassThrough, TheMeterMeasuresOverlapsWithoutContacts) {
    const auto noGravity = [](SystemSettings& settings) { settings.gravity.setZero(); };
    static Scene scene{.name = "overlapped", .description = ""};
    scene.adjust = noGravity;
    scene.build = [](SceneWorld& world) {
        const ShapePtr ball = world.SphereOf(0.5f);
        world.Add({.shape = ball, .position = {0, 0, 0}});
        world.Add({.shape = ball, .position = {2, 0, 0}});
    };
    Result<std::unique_ptr<SceneWorld>> world = SceneWorld::Create(scene);
    ASSERT_TRUE(world);
    PenetrationMeter meter(*world.Value());
    EXPECT_FALSE(meter.Measure());
    std::vector<BodyId> ids;
    world.Value()->System().VisitBodies([&](BodyId id) { ids.push_back(id); });
    ASSERT_TRUE(world.Value()->Bodies().SetPose(ids[1], {0.75, 0, 0}, {}));
    EXPECT_TRUE(meter.Measure());
    EXPECT_NEAR(meter.Worst().depth, 0.25, 1e-4);
    EXPECT_NEAR(meter.Worst().relative, 0.5, 1e-3);
}

// A closed slab has a far side, which whatever lies on it is behind.
TEST(PassThrough, TheMeterTellsTheNearSideOfAMeshFromTheFarSide) {
    static float thickness;
    static Scene scene{.name = "slab", .description = ""};
    scene.adjust = [](SystemSettings& settings) { settings.gravity.setZero(); };
    scene.build = [](SceneWorld& world) {
        std::vector<Vector3> corners;
        for (const float y : {-thickness, 0.0f})
            for (const auto& [x, z] : {std::pair{-2.0f, -2.0f}, {2.0f, -2.0f}, {2.0f, 2.0f}, {-2.0f, 2.0f}})
                corners.push_back({x, y, z});
        std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6};
        for (const uint32_t i : {0u, 1u, 2u, 3u}) {
            const uint32_t j = (i + 1) % 4;
            indices.insert(indices.end(), {i, 4 + i, j, j, 4 + i, 4 + j});
        }
        world.Add({.shape = world.MeshOf(corners, indices), .motion = MotionType::Static});
        world.Add({.shape = world.SphereOf(0.5f), .position = {0.3, 2, 0.1}});
    };
    const auto depthAt = [&](float slab, double height) {
        thickness = slab;
        Result<std::unique_ptr<SceneWorld>> world = SceneWorld::Create(scene);
        if (!world) return -1.0;
        PenetrationMeter meter(*world.Value());
        BodyId ball;
        world.Value()->System().VisitBodies([&](BodyId id) { ball = id; });
        EXPECT_TRUE(world.Value()->Bodies().SetPose(ball, {0.3, height, 0.1}, {}));
        meter.Measure();
        return meter.Worst().depth;
    };
    EXPECT_NEAR(depthAt(0.005f, 0.49), 0.01, 1e-4);  // lies on it
    EXPECT_NEAR(depthAt(1, 0.49), 0.01, 1e-4);
    EXPECT_NEAR(depthAt(1, -0.2), 0.7, 1e-4);     // in it, to rise by 0.7
    EXPECT_NEAR(depthAt(0.5f, -0.3), 0.7, 1e-4);  // nearer to the far side
}

// A soft row yields in proportion to its load: by D, extrapolated from a small load. Beyond a depth d, a quarter of the
// inner radius, it is stiffer: it yields by c = 1 - (x / d - 1) of that at a depth x, so that x = c D, or x = 2 D / (1
// + D / d).
TEST(PassThrough, ALightBallUnderAHeavyOneIsNotPressedIntoTheFloor) {
    const float radius = 0.05f;
    const auto depthUnder = [&](float weights) {
        SystemSettings settings;
        settings.accuracy.penetration = std::numeric_limits<float>::infinity();  // at the settings' effort alone
        settings.sleep.enabled = false;
        TestWorld world(settings);
        world.AddFloor();
        const LockedAxes upright = LockedAxes::TranslationX | LockedAxes::TranslationZ | LockedAxes::Rotation;
        const BodyId light =
            world.Add({.shape = SphereOf(radius), .position = {0, 0.05, 0}, .mass = 1, .lockedAxes = upright});
        world.Add({.shape = SphereOf(0.5f),
                   .position = {0, 0.6, 0},
                   .mass = 1,
                   .gravityFactor = weights,
                   .lockedAxes = upright});
        world.Run(10);
        EXPECT_LT(Length(world.VelocityOf(light)), 1e-3f);
        return double{radius} - world.PositionOf(light).y();
    };
    const double d = 0.25 * double{radius}, unit = depthUnder(49) / 50;
    ASSERT_LT(unit * 50, 0.5 * d);
    for (const float weights : {199.0f, 299.0f, 499.0f}) {
        const double soft = unit * (double{weights} + 1);
        ASSERT_GT(soft, 1.2 * d);
        EXPECT_NEAR(depthUnder(weights), 2 * soft / (1 + soft / d), 0.1 * d) << weights;
    }
}

// A rod without velocity rotates by 9 degrees in a step, which moves its end towards a wall by 0.23 m: less than its
// inner radius. Its bounds did not contain that motion, and the end was 8 cm inside the wall after the step.
TEST(PassThrough, AnEndThatRotatesIntoAWallIsForeseen) {
    for (const ContinuousCollision continuous : {ContinuousCollision::Off, ContinuousCollision::Linear}) {
        TestWorld world(NoGravity());
        world.Add({.shape = BoxOf(1, 5, 5), .motion = MotionType::Static, .position = {1.4, 0, 0}});
        const BodyId rod = world.Add(
            {.shape = BoxOf(0.25f, 1.5f, 0.25f), .angularVelocity = {0, 0, 0.16f * 480}, .continuous = continuous});
        world.Step(1.0 / 480);
        const Pose pose = world.Bodies().GetPose(rod);
        const Matrix3 axes = ToMatrix(pose.rotation);
        const double extent = double{0.25f * std::fabs(axes.x.x()) + 1.5f * std::fabs(axes.y.x())};
        EXPECT_LT(pose.position.x() + extent, 0.4 + 0.01) << static_cast<int>(continuous);
    }
}

}  // namespace
}  // namespace fulcrum::testing
