#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::GravityFactorsScene {
namespace {

constexpr double kStart = 20;  // m
constexpr std::array<float, 5> kFactors{-0.2f, 0, 0.25f, 0.5f, 1};
constexpr std::array<float, 3> kDamping{0.5f, 1, 2};  // 1/s
constexpr std::array<float, 2> kSpeedLimits{3, 6};    // m/s

// From left to right: the factors, the dampings, the limits.
void Build(SceneWorld& world) {
    world.AddFloor(20, 10);
    const ShapePtr ball = world.SphereOf(0.4f);
    double x = -6.75;
    const auto nextPlace = [&x] { return Position(x += 1.5, kStart, 0); };
    for (float factor : kFactors) {
        world.watched.push_back(world.Add({.shape = ball, .position = nextPlace(), .gravityFactor = factor}));
        world.Show(world.watched.back(), {.label = LabelOf(factor) + " g"});
    }
    for (float damping : kDamping)
        world.Show(world.Add({.shape = ball, .position = nextPlace(), .linearDamping = damping}),
                   {.label = LabelOf(damping) + "/s"});
    for (float limit : kSpeedLimits)
        world.Show(world.Add({.shape = ball, .position = nextPlace(), .maxLinearSpeed = limit}),
                   {.label = LabelOf(limit) + " m/s"});
}

// Before any has landed.
double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < kFactors.size(); ++i) {
        const double expected = kStart - 0.5 * 9.81 * kFactors[i] * world.Time() * world.Time();
        worst = std::max(worst, std::fabs(world.Bodies().GetPose(world.watched[i]).position.y() - expected));
    }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "gravity_factors",
    .description = "ten balls fall from one height: gravity factors -0.2 to 1, dampings in 1/s, speed limits in m/s",
    .steps = 114,
    .sleeping = false,
    .view = {.color = ColorMode::Plain, .from = {0, 0.05f, 1}, .picture = 0.75},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest error of a free ball's height against g t^2 / 2",
    .accuracyUnit = "m",
    // Velocities are floats: each of 114 steps rounds a speed of up to 19 m/s by up to 1e-6 of it, 2 s long: 0.1 mm.
    .accuracyRange = {{0, 0.0001}},
};

}  // namespace fulcrum::GravityFactorsScene
