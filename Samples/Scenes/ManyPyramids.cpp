#include <Fulcrum/Samples/Scenes/FlatPyramid.h>

namespace fulcrum::ManyPyramidsScene {
namespace {

constexpr int kRows = 14;

void Build(SceneWorld& world) {
    world.AddFloor(100, 100);
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kRows; ++column)
            AddFlatPyramid(world, cube, 10, 12.0 * (column - 6.5), 10.0 * (row - 6.5));
}

double Accuracy(const SceneWorld& world) { return WorstHeightError(world, 9.5); }

}  // namespace

extern const Scene kScene{
    .name = "many_pyramids",
    .description = "196 separate walls of 55 boxes: many islands",
    .kind = SceneKind::Performance,
    .steps = 100,
    .sleeping = false,
    .isBuiltToStand = true,
    .isClosed = true,
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest difference of a top box's height from 9.5 m",
    .accuracyUnit = "m",
    .accuracyRange = {{-0.01, 0.01}},
    .accuracyTolerance = 0.002,
};

}  // namespace fulcrum::ManyPyramidsScene
