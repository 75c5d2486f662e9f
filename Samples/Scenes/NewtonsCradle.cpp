#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <cmath>

namespace fulcrum::NewtonsCradleScene {
namespace {

constexpr int kBalls = 5;
constexpr double kRadius = 0.25, kRope = 2, kLift = 0.7;  // m, m, rad
// Five balls that touch and bounce without loss, each on a hinge above it; the first one is let go.
void Build(SceneWorld& world) {
    const ShapePtr ball = world.SphereOf(static_cast<float>(kRadius));
    for (int i = 0; i < kBalls; ++i) {
        const Position top(2 * kRadius * i, 3, 0);
        const Position down = i == 0 ? Position(-kRope * Sin(kLift), -kRope * Cos(kLift), 0) : Position(0, -kRope, 0);
        const BodyId body = world.Add(
            {.shape = ball, .position = top + down, .mass = 10, .material = {.friction = 0, .restitution = 1}});
        world.Join(JointOf<HingeJointSettings>(AddHook(world, top), body, top, {0, 0, 1}));
        world.watched.push_back(body);
    }
}

// The potential energy of the lifted first ball.
double EnergyChange(const SceneWorld& world) {
    const double lift = 10 * 9.81 * kRope * (1 - Cos(kLift)), lowest = 10 * 9.81 * (3 - kRope) * kBalls;
    return 100 * std::fabs(world.System().GetEnergy() - lowest - lift) / lift;
}

}  // namespace

extern const Scene kScene{
    .name = "newtons_cradle",
    .description = "Newton's cradle of five balls, there and back",
    .steps = 230,
    .sleeping = false,
    .isClosed = true,
    .build = Build,
    .accuracy = EnergyChange,
    .accuracyMeaning = "change of the energy, of what the first ball was lifted by",
    .accuracyUnit = "%",
    .accuracyRange = {{0, 15}},
};

}  // namespace fulcrum::NewtonsCradleScene
