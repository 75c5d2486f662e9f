#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::FlatLandScene {
namespace {

void Build(SceneWorld& world) {
    world.AddFloor(12, 4);
    for (double side : {-1.0, 1.0})
        world.Add({.shape = world.BoxOf(0.25f, 5, 1), .motion = MotionType::Static, .position = {6 * side, 5, 0}});
    const std::array<Vector3, 3> triangle{Vector3(-0.5f, -0.3f, 0), Vector3(0.5f, -0.3f, 0), Vector3(0, 0.6f, 0)};
    std::vector<Vector3> prism;
    for (const Vector3& corner : triangle)
        for (float z : {-0.3f, 0.3f}) prism.push_back(corner + Vector3(0, 0, z));
    const std::array<ShapePtr, 4> shapes{world.BoxOf(0.5f, 0.3f, 0.3f), world.SphereOf(0.4f), world.HullOf(prism),
                                         world.CapsuleOf(0.3f, 0.25f)};
    for (int row = 0; row < 14; ++row)
        for (int column = 0; column < 9; ++column) {
            const double shift = world.random.Between(-0.1, 0.1);
            const double angle = world.random.Between(-kPi, kPi);
            world.watched.push_back(world.Add({.shape = shapes[static_cast<size_t>(row + column) % shapes.size()],
                                               .position = {1.2 * (column - 4) + shift, 1 + 1.3 * row, 0},
                                               .rotation = RotationAbout(Vector3(0, 0, 1), angle),
                                               .lockedAxes = LockedAxes::Plane2D}));
        }
}

double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (BodyId id : world.watched) worst = std::max(worst, std::fabs(world.Bodies().GetCenterOfMass(id).z()));
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "flat_land",
    .description = "126 bodies locked to the x-y plane pile up between two walls",
    .steps = 480,
    .usesSeed = true,
    .view = {.color = ColorMode::Plain, .from = {0.15f, 0.1f, 1}},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest distance of a body's center from the plane",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 1e-06}},
};

}  // namespace fulcrum::FlatLandScene
