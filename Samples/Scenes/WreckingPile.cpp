#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>
#include <cmath>

namespace fulcrum::WreckingPileScene {
namespace {

constexpr int kGateOpens = 240;          // step
constexpr double kSlope = 30 * kDegree;  // of the ramp, which falls towards +x
const Position kRampCenter(-14, 4, 0);
constexpr float kBallRadius = 1.2f;

ShapePtr Jack(SceneWorld& world) {
    const ShapePtr bar = world.BoxOf(0.6f, 0.14f, 0.14f);
    const float quarter = static_cast<float>(std::sqrt(0.5));
    const std::array<Compound::ChildSettings, 3> bars{{{.shape = bar},
                                                       {.shape = bar, .rotation = {0, quarter, 0, quarter}},
                                                       {.shape = bar, .rotation = {0, 0, quarter, quarter}}}};
    return world.CompoundOf(bars);
}

ShapePtr Rock(SceneWorld& world) {
    std::vector<Vector3> points;
    for (int i = 0; i < 24; ++i) {
        const double y = world.random.Between(-1, 1), angle = world.random.Between(0, 2 * kPi);
        const double radius = world.random.Between(0.45, 0.6), flat = radius * std::sqrt(1 - y * y);
        points.push_back(Position(flat * Cos(angle), radius * y, flat * Sin(angle)).cast<float>());
    }
    return world.HullOf(points);
}

// Places along the ramp: `along` meters downhill of its center, `above` meters off its surface.
Position OnRamp(double along, double above) {
    const double sine = Sin(kSlope), cosine = Cos(kSlope), lift = above + 0.3;
    return kRampCenter + Position(along * cosine + lift * sine, -along * sine + lift * cosine, 0);
}

void AddRampAndBall(SceneWorld& world) {
    const Quaternion tilt = RotationAbout(Vector3(0, 0, 1), -kSlope);
    world.Add(
        {.shape = world.BoxOf(7, 0.3f, 2), .motion = MotionType::Static, .position = kRampCenter, .rotation = tilt});
    for (double side : {-1.0, 1.0})
        world.Add({.shape = world.BoxOf(7, 0.5f, 0.1f),
                   .motion = MotionType::Static,
                   .position = OnRamp(0, 0.5) + Position(0, 0, 1.9 * side),
                   .rotation = tilt});
    const BodyId gate = world.Add({.shape = world.BoxOf(0.1f, 1, 1.7f),
                                   .motion = MotionType::Kinematic,
                                   .position = OnRamp(-3.6, 1),
                                   .rotation = tilt});
    world.Add({.shape = world.SphereOf(kBallRadius),
               .position = OnRamp(-3.7 - kBallRadius, kBallRadius),
               .rotation = tilt,
               .density = 4000});
    world.watched.push_back(gate);
}

void Build(SceneWorld& world) {
    world.AddFloor(26, 26);
    world.AddWalls(25, 25, 3);
    const std::array<ShapePtr, 5> shapes{world.SphereOf(0.5f), world.BoxOf(0.5f, 0.4f, 0.3f),
                                         world.CapsuleOf(0.4f, 0.3f), Rock(world), Jack(world)};
    AddRampAndBall(world);
    for (int layer = 0; layer < 10; ++layer)
        for (int i = 0; i < 5; ++i)
            for (int j = 0; j < 5; ++j) {
                const double x = world.random.Between(-0.1, 0.1), z = world.random.Between(-0.1, 0.1);
                // Shifted from layer to layer: columns of one shape would stand.
                world.Add({.shape = shapes[static_cast<size_t>(i + j + 2 * layer) % shapes.size()],
                           .position = {1.25 * (i - 2) + x, 0.8 + 1.3 * layer, 1.25 * (j - 2) + z}});
            }
}

void OpenTheGate(SceneWorld& world, double) {
    const BodyId gate = world.watched[0];
    // In the ramp's plane: an upward motion would push the ball up the ramp.
    const Vector3 speed(static_cast<float>(6 * Sin(kSlope)), static_cast<float>(6 * Cos(kSlope)), 0);
    if (world.StepCount() == kGateOpens) (void)world.Bodies().SetVelocity(gate, speed, Vector3::Zero());
    if (world.StepCount() == kGateOpens + 30) (void)world.Bodies().SetVelocity(gate, Vector3::Zero(), Vector3::Zero());
}

}  // namespace

extern const Scene kScene{
    .name = "wrecking_pile",
    .description = "a heap of balls, boxes, capsules, rocks and jacks, hit by a ball of 29 t",
    .steps = 600,
    .usesSeed = true,
    .view = {.color = ColorMode::Plain, .lower = {-13, 0, -9}, .upper = {11, 7, 9}, .picture = 0.5},
    .build = Build,
    .beforeStep = OpenTheGate,
    .accuracy = BodiesBelowTheFloor,
    .accuracyMeaning = "bodies that fell through the floor",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::WreckingPileScene
