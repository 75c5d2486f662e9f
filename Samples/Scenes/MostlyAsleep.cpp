#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::MostlyAsleepScene {
namespace {

void Build(SceneWorld& world) {
    world.AddFloor(500, 500);
    const ShapePtr cube = world.BoxOf(0.25f, 0.25f, 0.25f);
    for (int i = 0; i < 400; ++i)
        for (int j = 0; j < 250; ++j)
            world.Add({.shape = cube, .position = {1.5 * (i - 199.5), 0.25, 1.5 * (j - 124.5)}, .startAsleep = true});
    const ShapePtr ball = world.SphereOf(0.5f);
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) world.Add({.shape = ball, .position = {20 * (i - 4.5), 10, 20 * (j - 4.5)}});
}

double Accuracy(const SceneWorld& world) { return world.LongestStepMs(); }

}  // namespace

extern const Scene kScene{
    .name = "mostly_asleep",
    .description = "100,000 sleeping boxes on a plain, 100 balls dropped among them",
    .kind = SceneKind::Performance,
    .steps = 300,
    .isClosed = true,
    .view = {.color = ColorMode::Awake,
             .from = {0.35f, 0.2f, 1},
             .lower = {-24, 0, -12},
             .upper = {24, 6, 16},
             .picture = 0.4},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "longest step but the first: what sleeps must cost nothing",
    .accuracyUnit = "ms",
};

}  // namespace fulcrum::MostlyAsleepScene
