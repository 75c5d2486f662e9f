#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <cmath>

namespace fulcrum::NewtonsCradleScene {
namespace {

constexpr int kBalls = 5;
constexpr double kRadius = 0.25, kRope = 2, kLift = 0.7;  // m, m, rad
constexpr double kApart = 0.6;                            // m, from a ball's plane to its hooks
constexpr double kPitch = 2 * kRadius;
// Five balls that touch and bounce without loss, each on two strings; the first one is let go. Strings leave a ball
// free to turn: on a hinge, each impact would turn it, too, and the hinge would take that back, with 1 % of the energy.
void Build(SceneWorld& world) {
    const ShapePtr ball = world.SphereOf(static_cast<float>(kRadius));
    for (int i = 0; i < kBalls; ++i) {
        const Position top(kPitch * i, 3, 0);
        const Position down = i == 0 ? Position(-kRope * Sin(kLift), -kRope * Cos(kLift), 0) : Position(0, -kRope, 0);
        const BodyId body = world.Add(
            {.shape = ball, .position = top + down, .mass = 10, .material = {.friction = 0, .restitution = 1}});
        for (const double side : {-kApart, kApart}) {
            const Position hook = top + Position(0, 0, side);
            world.Join(JointOfTwo<DistanceJointSettings>(AddHook(world, hook), body, hook, top + down));
        }
        world.watched.push_back(body);
    }
}

void DrawStrings(SceneWorld& world) {
    for (size_t i = 0; i < world.watched.size(); ++i) {
        const Position ball = world.Bodies().GetPose(world.watched[i]).position;
        for (const double side : {-kApart, kApart})
            world.Draw().Line(ball, Position(kPitch * static_cast<double>(i), 3, side), Ink::Miss);
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
    .description = "Newton's cradle of five balls on strings, which swings on",
    .steps = 1200,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.35f, 0.15f, 1}, .picture = 0.005, .showsJoints = false},
    .build = Build,
    .afterStep = DrawStrings,
    .accuracy = EnergyChange,
    .accuracyMeaning = "change of the energy, of what the first ball was lifted by",
    .accuracyUnit = "%",
    // Each of 14 impacts is timed within a step, and loses or gains some 0.1 %.
    .accuracyRange = {{0, 1}},
};

}  // namespace fulcrum::NewtonsCradleScene
