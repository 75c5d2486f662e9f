#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::TowerScene {
namespace {

constexpr int kBoxes = 20;

void Build(SceneWorld& world) {
    world.AddFloor(20, 20);
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    for (int i = 0; i < kBoxes; ++i) {
        const double x = world.random.Between(-0.01, 0.01), z = world.random.Between(-0.01, 0.01);
        world.watched.push_back(world.Add({.shape = cube, .position = {x, 0.5 + i, z}}));
    }
}

double Accuracy(const SceneWorld& world) {
    return world.Bodies().GetPose(world.watched.back()).position.y() - (kBoxes - 0.5);
}

}  // namespace

extern const Scene kScene{
    .name = "tower",
    .description = "20 boxes stacked up to 1 cm out of line: the tower stands and falls asleep",
    .steps = 600,
    .usesSeed = true,
    .isBuiltToStand = true,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.5f, 0.2f, 1}},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of the top box minus 19.5 m, that of a perfect stack",
    .accuracyUnit = "m",
    // Overlaps carry weight like springs of w = 2 pi 51/s on the reduced mass m / 2: below k boxes 2 k g / w^2, in all
    // 38 mm.
    .accuracyRange = {{-0.03, 0.001}},
};

}  // namespace fulcrum::TowerScene
