#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::DistanceScene {
namespace {

constexpr double kFrequency = 1;  // Hz, of the spring
enum : size_t { kRod, kRope, kSpring, kTether };

JointId Hang(SceneWorld& world, double x, const Position& from, std::optional<float> min, std::optional<float> max,
             double frequency = 0) {
    const Position top(x, 5, 0), place = top + from;
    const BodyId ball = world.Add({.shape = world.SphereOf(0.2f), .position = place, .mass = 5});
    auto settings = JointOfTwo<DistanceJointSettings>(AddHook(world, top), ball, top, place);
    settings.minDistance = min;
    settings.maxDistance = max;
    settings.spring.frequency = static_cast<float>(frequency);
    settings.spring.dampingRatio = 1;
    return world.Join(settings);
}

// A rod that swings, a rope that falls taut, a spring that carries a weight, a ball that is kept between two distances.
void Build(SceneWorld& world) {
    world.AddFloor(10, 6);
    world.joints = {Hang(world, -4, {1.5, 0, 0}, std::nullopt, std::nullopt),
                    Hang(world, 0, {0.5, 0.5, 0}, std::nullopt, 2.0f),
                    Hang(world, 3, {0, -1, 0}, 1.0f, 1.0f, kFrequency), Hang(world, 6, {0.6, -0.9, 0}, 1.0f, 1.5f)};
}

double Accuracy(const SceneWorld& world) {
    const auto length = [&](size_t joint) {
        return world.Joints().GetCoordinate(world.joints[joint], JointAxis::LinearX);
    };
    // At rest the spring is longer by g / w^2.
    const double omega = 2 * kPi * kFrequency;
    return std::max({std::fabs(length(kRod) - 1.5), length(kRope) - 2,
                     std::fabs(length(kSpring) - 1 - 9.81 / (omega * omega)), length(kTether) - 1.5,
                     1 - length(kTether)});
}

}  // namespace

extern const Scene kScene{
    .name = "distance",
    .description = "distance joints: a rod, a rope, a spring that carries a weight, a ball kept between two distances",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest error of a length",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::DistanceScene
