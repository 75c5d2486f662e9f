#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>

namespace fulcrum::DominoesScene {
namespace {

constexpr int kDominoes = 72;
constexpr double kRadius = 4;            // m, of the arc's middle
constexpr double kStep = 4.2 * kDegree;  // 0.29 m between neighbors, 0.6 of their height

// Along a circle about the y axis: `angle` 0 is at x = radius, and rises towards -z.
Position OnCircle(double angle, double radius, double height) {
    return {radius * Cos(angle), height, -radius * Sin(angle)};
}

// A spiral of dominoes, so that the end does not meet the beginning; a ball rolls into the first.
void Build(SceneWorld& world) {
    world.AddFloor(6, 6);
    world.AddWalls(5.5f, 5.5f, 0.3f);
    const ShapePtr domino = world.BoxOf(0.1f, 0.25f, 0.03f);  // its thickness is along the arc
    for (int i = 0; i < kDominoes; ++i) {
        const double angle = i * kStep;
        world.watched.push_back(world.Add({.shape = domino,
                                           .position = OnCircle(angle, kRadius - 0.012 * i, 0.25),
                                           .rotation = RotationAbout(Vector3(0, 1, 0), angle)}));
    }
    world.Add({.shape = world.SphereOf(0.15f),
               .position = Position(kRadius, 0.15, 0.8),
               .linearVelocity = {0, 0, -2.5f},
               .angularVelocity = {-2.5f / 0.15f, 0, 0}});
}

// A fallen domino's own y axis lies down or leans on the next one.
double Accuracy(const SceneWorld& world) {
    return static_cast<double>(std::count_if(world.watched.begin(), world.watched.end(), [&](BodyId id) {
        return Rotate(world.Bodies().GetPose(id).rotation, Vector3(0, 1, 0)).y() > 0.8f;
    }));
}

}  // namespace

extern const Scene kScene{
    .name = "dominoes",
    .description = "a ball topples a curved row of 72 dominoes",
    .steps = 720,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.3f, 0.7f, 1}, .picture = 0.4},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "dominoes left standing",
    .accuracyUnit = "dominoes",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::DominoesScene
