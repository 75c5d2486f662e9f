#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <array>

namespace fulcrum::MovingPlatformsScene {
namespace {

enum Platform : size_t { kLift, kShuttle, kTurntable, kSweeper, kPlatforms };

// Where the platforms are after `time` seconds; all begin at rest. Accelerations are small enough for friction.
Pose PlatformPose(size_t platform, double time) {
    switch (platform) {
        case kLift: return {Position(-6, 1.75 - 1.25 * Cos(2 * kPi * time / 4), 0), {}};
        case kShuttle: return {Position(-1 - 1.5 * Cos(2 * kPi * time / 5), 0.5, 4), {}};
        case kTurntable: {
            const double turned = time < 3 ? 0.2 * time * time : 1.2 * time - 1.8;  // up to 1.2 rad/s within 3 s
            return {Position(0, 0.5, -1), RotationAbout(Vector3(0, 1, 0), turned)};
        }
        default: return {Position(6, 0.5, 0), RotationAbout(Vector3(0, 1, 0), 0.4 * time * std::min(time, 2.0))};
    }
}

struct Carried {
    Platform platform;
    Position offset;  // of the center of a cube of half 0.3 m, from the platform's
};
constexpr double kOnTop = 0.15 + 0.3;
const std::array<Carried, 11> kCarried{{{kLift, {0, kOnTop, 0}},
                                        {kLift, {0, kOnTop + 0.6, 0}},
                                        {kLift, {0, kOnTop + 1.2, 0}},
                                        {kLift, {0, kOnTop + 1.8, 0}},
                                        {kShuttle, {-0.8, kOnTop, 0}},
                                        {kShuttle, {0, kOnTop, 0}},
                                        {kShuttle, {0.8, kOnTop, 0}},
                                        {kTurntable, {1.1, kOnTop, 0}},
                                        {kTurntable, {-1.1, kOnTop, 0}},
                                        {kTurntable, {0, kOnTop, 1.1}},
                                        {kTurntable, {0, kOnTop, -1.1}}}};

ShapePtr Disc(SceneWorld& world) {
    std::vector<Vector3> rim;
    for (int i = 0; i < 24; ++i)
        for (double y : {-0.15, 0.15})
            rim.push_back(Position(2 * Cos(2 * kPi * i / 24), y, 2 * Sin(2 * kPi * i / 24)).cast<float>());
    return world.HullOf(rim);
}

void Build(SceneWorld& world) {
    world.AddFloor(14, 10);
    world.AddWalls(12, 8, 0.5f);
    const std::array<ShapePtr, kPlatforms> shapes{world.BoxOf(0.8f, 0.15f, 0.8f), world.BoxOf(1.4f, 0.15f, 0.8f),
                                                  Disc(world), world.BoxOf(2.5f, 0.4f, 0.1f)};
    for (size_t i = 0; i < kPlatforms; ++i) {
        const Pose pose = PlatformPose(i, 0);
        world.watched.push_back(world.Add({.shape = shapes[i],
                                           .motion = MotionType::Kinematic,
                                           .position = pose.position,
                                           .rotation = pose.rotation}));
    }
    const ShapePtr cube = world.BoxOf(0.3f, 0.3f, 0.3f), ball = world.SphereOf(0.3f);
    for (const Carried& carried : kCarried)
        world.watched.push_back(
            world.Add({.shape = cube, .position = PlatformPose(carried.platform, 0).position + carried.offset}));
    // Boxes that the sweeper pushes.
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 3; ++j)
            world.Add({.shape = (i + j) % 2 == 0 ? cube : ball, .position = {5.2 + 0.8 * i, 0.3, 0.8 + 0.8 * j}});
}

void MoveThePlatforms(SceneWorld& world, double dt) {
    for (size_t i = 0; i < kPlatforms; ++i) {
        const Pose target = PlatformPose(i, world.Time() + dt);
        (void)world.Bodies().MoveKinematic(world.watched[i], target.position, target.rotation, static_cast<float>(dt));
    }
}

// How far a cube has slid from where it was put on its platform.
double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < kCarried.size(); ++i) {
        const Pose platform = world.Bodies().GetPose(world.watched[kCarried[i].platform]);
        const Position cube = world.Bodies().GetPose(world.watched[kPlatforms + i]).position;
        const Position offset = platform.InverseTransform(cube).cast<double>();
        worst = std::max(worst, (offset - kCarried[i].offset).norm());
    }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "moving_platforms",
    .description = "a lift, a shuttle and a turntable carry boxes, a turning bar sweeps others away",
    .steps = 720,
    .view = {.color = ColorMode::Plain, .lower = {-7, 0, -5}, .upper = {12, 5, 6}, .picture = 0.5},
    .build = Build,
    .beforeStep = MoveThePlatforms,
    .accuracy = Accuracy,
    .accuracyMeaning = "farthest that a box slid on what carries it",
    .accuracyUnit = "m",
    // Friction makes velocities equal, and a step along the tangent of a turning disc leads outwards by (w dt)^2 r /
    // 2.
    .accuracyRange = {{0, 0.03}},
};

}  // namespace fulcrum::MovingPlatformsScene
