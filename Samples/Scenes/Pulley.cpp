#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::PulleyScene {
namespace {

constexpr double kJib = 6;    // m, height of the jib
constexpr float kTackle = 3;  // parts of the rope at the load
enum : size_t { kWinch, kBalance };

double LengthAt(double time) { return 12.5 - 3 * Sin(0.5 * time); }

// A crane: the winch shortens a rope that runs three times between jib and load. Beside it a rope with a weight at
// either end.
void Build(SceneWorld& world) {
    world.AddFloor(12, 6);
    world.Add({.shape = world.BoxOf(0.2f, 3, 0.2f), .motion = MotionType::Static, .position = {-8, 3, 0}});
    world.Add({.shape = world.BoxOf(3, 0.15f, 0.15f), .motion = MotionType::Static, .position = {-5.2, kJib + 0.2, 0}});
    const Position tip(-3, kJib, 0), drum(-7, kJib, 0);
    const BodyId anchor = AddHook(world, {-7, 4.5, 0});
    const BodyId load = world.Add({.shape = world.BoxOf(0.5f, 0.5f, 0.5f), .position = {-3, 2, 0}, .mass = 300});
    auto rope = JointOfTwo<PulleyJointSettings>(anchor, load, {-7, 4.5, 0}, {-3, 2.5, 0});
    rope.fixedPointA = drum;
    rope.fixedPointB = tip;
    rope.ratio = kTackle;
    rope.maxLength = static_cast<float>(LengthAt(0));
    world.joints.push_back(world.Join(rope));

    const BodyId light = world.Add({.shape = world.SphereOf(0.3f), .position = {3, 1, 0}, .mass = 10});
    const BodyId heavy = world.Add({.shape = world.SphereOf(0.4f), .position = {5, 5, 0}, .mass = 12});
    auto balance = JointOfTwo<PulleyJointSettings>(light, heavy, {3, 1, 0}, {5, 5, 0});
    balance.fixedPointA = {3, 7, 0};
    balance.fixedPointB = {5, 7, 0};
    world.joints.push_back(world.Join(balance));
}

// Winding is a change of the rope's length, step by step.
void Wind(SceneWorld& world, double dt) {
    JointLimits limits;
    limits.max = static_cast<float>(LengthAt(world.Time() + dt));
    (void)world.Joints().SetLimits(world.joints[kWinch], JointAxis::LinearX, limits);
}

double Accuracy(const SceneWorld& world) {
    const auto length = [&](size_t joint) {
        return world.Joints().GetCoordinate(world.joints[joint], JointAxis::LinearX);
    };
    return std::max(length(kWinch) - LengthAt(world.Time()), length(kBalance) - 8);
}

}  // namespace

extern const Scene kScene{
    .name = "pulley",
    .description = "a crane whose winch lifts a load by a block and tackle, and two weights on a rope over a pulley",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = Wind,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest length by which a rope is stretched",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::PulleyScene
