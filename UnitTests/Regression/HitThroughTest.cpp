// A body that is hit within a step is deflected: it moves towards what its velocity at the start of the step does not
// lead to, and its free end comes down. A plate that stood on one edge was pressed through the floor by the half
// thickness four times over when a heavier body fell onto it, since its contact with the floor was that of the edge.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr float kThickness = 0.04f;  // m, half

struct Depths {
    int deep = 0;      // plates that were deeper than a tenth
    double worst = 0;  // of the half thickness
};

// Drops boxes, drums and balls of 200 kg or so, or of `ratio` times its mass, at 2 to 12 m/s onto a plate of 64 kg that
// leans on one edge by up to 0.15 rad, and measures how deep a corner of it gets into the floor.
Depths DropOntoPlates(int substeps, int count, float ratio = 0) {
    Depths depths;
    for (int seed = 1; seed <= count; ++seed) {
        RandomPoses random(static_cast<uint32_t>(seed));
        SystemSettings settings;
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.AddFloor();
        const float angle = 0.075f * (1 + random.Between(-1, 1)), speed = 7 + 5 * random.Between(-1, 1);
        const double height = double{0.4f * std::sin(angle) + kThickness * std::cos(angle)};
        const Vector3 half(0.5f, kThickness, 0.4f);
        const BodyId plate = world.Add({.shape = Box::Create(half).Value(),
                                        .position = {0, height + 1e-4, 0},
                                        .rotation = RotationAbout(Vector3(1, 0, 0), -angle)});
        const ShapePtr shapes[] = {CubeOf(0.3f), SphereOf(0.35f), Cylinder::Create(0.4f, 0.3f).Value()};
        const BodyId dropped = world.Add(
            {.shape = shapes[seed % 3],
             .position = {0.25 * double{random.Between(-1, 1)}, height + 0.7 + 0.15 * double{random.Between(-1, 1)},
                          0.25 * double{random.Between(-1, 1)}},
             .rotation = random.Rotation(),
             .linearVelocity = {0, -speed, 0}});
        if (ratio > 0 && !world.Bodies().SetMass(dropped, ratio * world.Bodies().GetMass(plate))) ADD_FAILURE();
        double deepest = 0;
        for (int step = 0; step < 30; ++step) {
            world.Step();
            const Pose pose = world.Bodies().GetPose(plate);
            for (int corner = 0; corner < 8; ++corner) {
                const Vector3 at(corner & 1 ? half.x() : -half.x(), corner & 2 ? half.y() : -half.y(),
                                 corner & 4 ? half.z() : -half.z());
                deepest = std::max(deepest, -pose.position.y() - double{Rotate(pose.rotation, at).y()});
            }
        }
        depths.worst = std::max(depths.worst, deepest / double{kThickness});
        depths.deep += deepest > 0.1 * double{kThickness};
    }
    return depths;
}

// Its contact with the floor is soft, and of the hit an iteration stops a part only: with position iterations for what
// has deepened, hardly any is deeper than a tenth, at any effort and whatever the masses (figures in Docs/Step.md).
TEST(HitThrough, APlateOnItsEdgeIsNotPressedThroughTheFloor) {
    const int count = Cases(200);
    for (const float ratio : {0.0f, 1.0f, 1.9f, 20.0f}) {
        SCOPED_TRACE(::testing::Message() << "mass ratio " << ratio);
        const Depths coarse = DropOntoPlates(1, count, ratio), usual = DropOntoPlates(4, count, ratio),
                     fine = DropOntoPlates(16, count, ratio);
        EXPECT_LT(coarse.worst, 0.3);
        EXPECT_LT(usual.worst, 0.2);
        EXPECT_LE(usual.deep, count / 10);
        EXPECT_LT(fine.worst, 0.15);
        EXPECT_LE(fine.deep, count / 50);
    }
}

// A ball that flies up from the floor leaves it behind: its bounds extend upwards. Hit from above within the step, it
// goes down again, by more than its way up.
TEST(HitThrough, ABallThatFliesUpIsHitDownOntoTheFloor) {
    for (const float mass : {1.0f, 8.0f}) {
        TestWorld world(NoGravity());
        world.Add({.shape = BoxOf(5, 1, 5), .motion = MotionType::Static, .position = {0, -1, 0}});
        const float radius = 0.5f, up = 6, down = 20;
        const BodyId ball =
            world.Add({.shape = SphereOf(radius), .position = {0, 0.5, 0}, .linearVelocity = {0, up, 0}, .mass = 1});
        const double gap = double{up + down} / 60 + 0.05;
        world.Add(
            {.shape = SphereOf(radius), .position = {0, 1.5 + gap, 0}, .linearVelocity = {0, -down, 0}, .mass = mass});
        world.Step();
        ASSERT_NEAR(world.PositionOf(ball).y(), double{radius + up / 60}, 1e-4);
        for (int step = 0; step < 10; ++step) {
            world.Step();
            EXPECT_GT(world.PositionOf(ball).y(), 0.95 * double{radius}) << "mass " << mass << ", step " << step;
        }
    }
}

// Of a tapered capsule that stands on one end the other had no contact before it leaned by less than two degrees: what
// tipped over fast went into the floor, by half of its inner radius.
TEST(HitThrough, ATaperedCapsuleTipsOverOntoItsOtherEnd) {
    const float top = 0.12f, bottom = 0.28f, halfHeight = 0.4f;
    double worst = 0;
    const int count = Cases(100);
    for (int seed = 1; seed <= count; ++seed) {
        RandomPoses random(static_cast<uint32_t>(seed));
        TestWorld world;
        world.AddFloor();
        const ShapePtr shape = TaperedCapsule::Create(halfHeight, top, bottom).Value();
        const float lean = random.Between(0.3f, 1.3f), speed = random.Between(2, 14);
        const Quaternion rotation = RotationAbout(Vector3(1, 0, 0), lean);
        const float ofEnd = Rotate(rotation, Vector3(0, -halfHeight, 0)).y() - bottom;
        const BodyId id = world.Add({.shape = shape,
                                     .position = {0, -double{ofEnd}, 0},
                                     .rotation = rotation,
                                     .linearVelocity = Cross<float>(Vector3(speed, 0, 0), Vector3(0, -ofEnd, 0)),
                                     .angularVelocity = {speed, 0, 0}});
        for (int step = 0; step < 60; ++step) {
            world.Step();
            const Pose pose = world.Bodies().GetPose(id);
            const auto depthOf = [&](float y, float radius) {
                return double{radius} - pose.position.y() - double{Rotate(pose.rotation, Vector3(0, y, 0)).y()};
            };
            worst = std::max({worst, depthOf(-halfHeight, bottom), depthOf(halfHeight, top)});
        }
    }
    EXPECT_LT(worst, 0.005);
}

// What rolls fast over the ridge between two triangles had a contact with the ridge alone, and its corners went through
// the faces beside it, by up to 0.16 inner radii.
TEST(HitThrough, CornersOfWhatRollsOverARidgeStopAtTheFacesBesideIt) {
    const float slope = 0.4f;
    const std::vector<Vector3> corners = {{-9, -9 * slope, -9}, {0, 0, -9}, {9, -9 * slope, -9},
                                          {-9, -9 * slope, 9},  {0, 0, 9},  {9, -9 * slope, 9}};
    const std::vector<uint32_t> indices = {0, 3, 1, 1, 3, 4, 1, 4, 2, 2, 4, 5};
    const ShapePtr ridge = TriangleMesh::Create({.vertices = corners, .indices = indices}).Value();
    const float size = 0.3f, golden = 1.618034f * size, out = std::sqrt(1 + slope * slope);
    const std::vector<Vector3> points = {{0, size, golden},   {0, -size, golden},  {0, size, -golden},
                                         {0, -size, -golden}, {size, golden, 0},   {-size, golden, 0},
                                         {size, -golden, 0},  {-size, -golden, 0}, {golden, 0, size},
                                         {golden, 0, -size},  {-golden, 0, size},  {-golden, 0, -size}};
    const ShapePtr ball = ConvexHull::Create(points).Value();
    const double inner = double{static_cast<const ConvexShape&>(*ball).InnerRadius()};
    double worst = 0;
    const int count = Cases(200);
    for (int seed = 1; seed <= count; ++seed) {
        RandomPoses random(static_cast<uint32_t>(seed));
        TestWorld world;
        world.Add({.shape = ridge, .motion = MotionType::Static});
        const float x = random.Between(-0.5f, 0.5f), side = random.Between(-4, 4), down = random.Between(1, 16),
                    spin = random.Between(-12, 12);
        const Quaternion rotation = random.Rotation();
        const BodyId id = world.Add({.shape = ball,
                                     .position = {double{x}, 0.8, 0},
                                     .rotation = rotation,
                                     .linearVelocity = {side, -down, 0},
                                     .angularVelocity = {0, 0, spin}});
        for (int step = 0; step < 60; ++step) {
            world.Step();
            const Pose pose = world.Bodies().GetPose(id);
            for (const Vector3& point : points) {
                const Position at = pose.position + Rotate(pose.rotation, point).cast<double>();
                worst = std::max(worst, -(at.y() + double{slope} * std::fabs(at.x())) / double{out});
            }
        }
    }
    EXPECT_LT(worst, 0.05 * inner);
}

}  // namespace
}  // namespace fulcrum::testing
