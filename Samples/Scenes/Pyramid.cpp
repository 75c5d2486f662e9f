#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::PyramidScene {
namespace {

constexpr int kLayers = 15;

// 1240 cubes of 2 m, half a meter apart in height: the pyramid falls together, each layer on the one below.
void Build(SceneWorld& world) {
    world.AddFloor(50, 50);
    const ShapePtr cube = world.BoxOf(1, 1, 1);
    for (int i = 0; i < kLayers; ++i) {
        const double shift = i % 2 == 0 ? 0 : 1;
        for (int j = i / 2; j < kLayers - (i + 1) / 2; ++j)
            for (int k = i / 2; k < kLayers - (i + 1) / 2; ++k) {
                const Position place(-15 + 2 * j + shift, 1 + 2.5 * i, -15 + 2 * k + shift);
                const BodyId id = world.Add({.shape = cube, .position = place});
                if (i == kLayers - 1) world.watched.push_back(id);
            }
    }
}

double Accuracy(const SceneWorld& world) { return world.Bodies().GetPose(world.watched[0]).position.y() - 29.0; }

}  // namespace

extern const Scene kScene{
    .name = "pyramid",
    .description = "1240 boxes fall into a square pyramid of 15 layers, one large island",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .isBuiltToStand = true,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .picture = 0.3},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of the top box minus 29 m, that of a perfect stack",
    .accuracyUnit = "m",
    .accuracyRange = {{-0.01, 0.01}},
    .accuracyTolerance = 0.002,
};

}  // namespace fulcrum::PyramidScene
