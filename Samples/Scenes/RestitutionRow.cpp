#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::RestitutionRowScene {
namespace {

constexpr double kStart = 5;  // m, of the balls' centers
constexpr float kRadius = 0.4f;

void Build(SceneWorld& world) {
    world.AddFloor(20, 20);
    const ShapePtr ball = world.SphereOf(kRadius);
    for (int i = 0; i <= 10; ++i)
        world.watched.push_back(world.Add({.shape = ball,
                                           .position = {1.2 * (i - 5), kStart, 0},
                                           .material = {.restitution = 0.1f * static_cast<float>(i)}}));
    for (size_t i = 0; i <= 10; ++i) world.Show(world.watched[i], {.label = LabelOf(0.1 * static_cast<double>(i))});
}

// Of the ball that loses nothing: the height that it could climb to.
double Accuracy(const SceneWorld& world) {
    const BodyId ball = world.watched.back();
    const double speed = world.Bodies().GetLinearVelocity(ball).y();
    return world.Bodies().GetPose(ball).position.y() + speed * speed / (2 * 9.81) - kStart;
}

}  // namespace

extern const Scene kScene{
    .name = "restitution_row",
    .description = "eleven balls with restitution 0 to 1 bounce side by side",
    .steps = 600,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0, 0.12f, 1}, .picture = 0.19},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "energy height of the ball with restitution 1 minus its start",
    .accuracyUnit = "m",
    // Each impact is timed within a step: 5 m of height, 1 %.
    .accuracyRange = {{-0.05, 0.05}},
};

}  // namespace fulcrum::RestitutionRowScene
