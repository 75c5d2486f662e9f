#include <Fulcrum/Samples/Scenes/FlatPyramid.h>

namespace fulcrum::LargePyramidScene {
namespace {

void Build(SceneWorld& world) {
    world.AddFloor(400, 400);
    AddFlatPyramid(world, world.BoxOf(0.5f, 0.5f, 0.5f), 100, 0, 0);
}

double Accuracy(const SceneWorld& world) { return WorstHeightError(world, 99.5); }

}  // namespace

extern const Scene kScene{
    .name = "large_pyramid",
    .description = "5050 boxes in a wall of 100 layers that tapers to one box",
    .kind = SceneKind::Performance,
    .steps = 200,
    .sleeping = false,
    .isBuiltToStand = true,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.25f, 0.15f, 1}},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of the top box minus 99.5 m, that of a perfect stack",
    .accuracyUnit = "m",
    .accuracyRange = {{-1, 0.01}},
    .accuracyTolerance = 0.25,
};

}  // namespace fulcrum::LargePyramidScene
