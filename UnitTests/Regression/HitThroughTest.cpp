// A body that is hit within a step is deflected: it moves towards what its velocity at the start of the step does not
// lead to, and its free end comes down. A plate that stood on one edge was pressed through the floor by the half
// thickness four times over when a heavier body fell onto it, since its contact with the floor was that of the edge.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/RoundShapes.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr float kThickness = 0.04f;  // m, half

struct Depths {
    int deep = 0;      // plates that were deeper than a tenth
    double worst = 0;  // of the half thickness
};

// Drops boxes, drums and balls of 200 kg or so at 2 to 12 m/s onto a plate of 64 kg that leans on one edge by up to
// 0.15 rad, and measures how deep a corner of it gets into the floor.
Depths DropOntoPlates(int substeps, int count) {
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
        world.Add(
            {.shape = shapes[seed % 3],
             .position = {0.25 * double{random.Between(-1, 1)}, height + 0.7 + 0.15 * double{random.Between(-1, 1)},
                          0.25 * double{random.Between(-1, 1)}},
             .rotation = random.Rotation(),
             .linearVelocity = {0, -speed, 0}});
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

TEST(HitThrough, APlateOnItsEdgeIsNotPressedThroughTheFloor) {
    const int count = Cases(200);
    const Depths usual = DropOntoPlates(4, count), fine = DropOntoPlates(16, count);
    EXPECT_LT(usual.worst, 0.8);
    EXPECT_LT(fine.worst, 0.3);
    EXPECT_LE(fine.deep, count / 20);
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

}  // namespace
}  // namespace fulcrum::testing
