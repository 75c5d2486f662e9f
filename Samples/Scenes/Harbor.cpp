#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Fields/Fields.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::HarborScene {
namespace {

constexpr double kLevel = 3;   // m, of the water
constexpr float kHalf = 0.4f;  // m, of the crates
// Of the crates, in kg/m3: the last sinks.
constexpr std::array<float, 6> kDensities{100, 250, 400, 550, 700, 1300};

void Build(SceneWorld& world) {
    world.AddFloor(12, 12);
    world.AddWalls(12, 12, 5);
    const ShapePtr crate = world.BoxOf(1.5f * kHalf, kHalf, 1.5f * kHalf);
    for (size_t i = 0; i < kDensities.size(); ++i)
        world.watched.push_back(world.Add({.shape = crate,
                                           .position = {-6 + 2.4 * static_cast<double>(i), kLevel + 1.5, 5},
                                           .rotation = RotationAbout({1, 0, 0}, 0.2 * static_cast<double>(i)),
                                           .density = kDensities[i]}));
    // A barge that heels by 40 degrees as it is launched.
    world.watched.push_back(world.Add({.shape = world.BoxOf(2, 0.8f, 4),
                                       .position = {0, kLevel + 0.5, -3},
                                       .rotation = RotationAbout({0, 0, 1}, 0.7),
                                       .density = 450}));
    // Buoys driven by the wind, and bodies that roll off them.
    for (int i = 0; i < 12; ++i)
        world.Add({.shape = i % 3 == 0 ? world.CapsuleOf(0.5f, 0.25f) : world.SphereOf(0.3f),
                   .position = {-8 + 0.3 * i, kLevel + 2 + 0.7 * i, -8 + 0.1 * i},
                   .density = 200});
}

void ApplyFields(SceneWorld& world, double dt) {
    Fields fields;
    fields.waters.push_back({.level = kLevel, .drag = 1, .angularDrag = 1.5f});
    // Along one quay, for the first ten seconds.
    if (world.Time() < 10)
        fields.winds.push_back({.region = {.lower = {-12, 0, -12}, .upper = {12, 20, -7}},
                                .velocity = {12, 0, 0},
                                .dragCoefficient = 0.5f});
    (void)fields.Apply(world.System(), dt);
}

// Deviation of crates and barge from the height at which they displace their weight, m, and of the barge from upright,
// rad. The crate that sinks lies on the floor.
double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < kDensities.size(); ++i) {
        const double part = std::min(double{kDensities[i]} / 1000, 1.0), size = 2 * double{kHalf};
        const double height = part < 1 ? kLevel + size * (0.5 - part) : double{kHalf};
        worst = std::max(worst, std::fabs(world.Bodies().GetPose(world.watched[i]).position.y() - height));
    }
    const Pose barge = world.Bodies().GetPose(world.watched[kDensities.size()]);
    worst = std::max(worst, std::fabs(barge.position.y() - (kLevel + 1.6 * (0.5 - 0.45))));
    const Vector3 up = Rotate(barge.rotation, Vector3(0, 1, 0));
    return std::max(worst, Acos(std::min(1.0, double{up.y()})));
}

}  // namespace

extern const Scene kScene{
    .name = "harbor",
    .description = "crates float as deep as they are heavy, a heeled barge rights itself, wind drives buoys",
    .steps = 1800,
    .view = {.color = ColorMode::Plain,
             .from = {0.45f, 0.6f, 1},
             .lower = {-11, 2, -10},
             .upper = {11, 4.5, 10},
             .picture = 0.3,
             .waterLower = {-12, 0, -12},
             .waterUpper = {12, kLevel, 12}},
    .build = Build,
    .beforeStep = ApplyFields,
    .accuracy = Accuracy,
    .accuracyMeaning = "farthest from floating at rest, or the barge's heel",
    .accuracyUnit = "m or rad",
    .accuracyRange = {{0, 0.03}},
};

}  // namespace fulcrum::HarborScene
