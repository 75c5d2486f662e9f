#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::BulletsScene {
namespace {

constexpr int kRows = 9;
constexpr double kWall = 30;  // m: where the fronts of the walls stand

// Balls of 10 cm at 200, 600 and 1000 m/s at walls of 1 and 10 cm; rods that turn at 100 rad/s between thin posts; all
// must stay on their side.
void Build(SceneWorld& world) {
    world.AddFloor(40, 40);
    const ShapePtr ball = world.SphereOf(0.1f), rod = world.BoxOf(1, 0.03f, 0.03f), post = world.CapsuleOf(1, 0.03f);
    for (int i = 0; i < kRows; ++i) {
        const double z = 3.0 * (i - kRows / 2);
        const float half = i % 2 == 0 ? 0.005f : 0.05f, speed = i % 3 == 0 ? 200.0f : i % 3 == 1 ? 600.0f : 1000.0f;
        world.Add({.shape = world.BoxOf(half, 1.5f, 1.3f),
                   .motion = MotionType::Static,
                   .position = {kWall + double{half}, 1.5, z}});
        for (int k = 0; k < 5; ++k)
            world.watched.push_back(world.Add({.shape = ball,
                                               .position = {-15 - 4.0 * k, 0.5 + 0.5 * k, z},
                                               .linearVelocity = {speed, 0, 0},
                                               .material = {.restitution = 0.4f},
                                               .gravityFactor = 0.2f,
                                               .continuous = ContinuousCollision::Linear}));
        for (const double side : {-0.7, 0.7})
            world.Add({.shape = post, .motion = MotionType::Static, .position = {-8 + side, 1, z}});
        world.Add({.shape = rod,
                   .position = {-8, 1 + 0.1 * i, z},
                   .rotation = {0, 0.70710678f, 0, 0.70710678f},
                   .angularVelocity = {0, 100, 0},
                   .material = {.restitution = 0.6f},
                   .continuous = ContinuousCollision::LinearAndAngular});
    }
}

// How far each fast body came in the step.
void DrawTrails(SceneWorld& world) {
    if (!world.Draw().IsOn()) return;
    for (const BodyId body : world.watched) {
        const Position at = world.Bodies().GetPose(body).position;
        const Vector3 velocity = world.Bodies().GetLinearVelocity(body);
        if (Length(velocity) > 10) world.Draw().Line(at - velocity.cast<double>() / 60, at, Ink::Path);
    }
}

double BallsBehindTheWalls(const SceneWorld& world) {
    double count = 0;
    for (const BodyId body : world.watched) count += !(world.Bodies().GetPose(body).position.x() < kWall);
    return count;
}

}  // namespace

extern const Scene kScene{
    .name = "bullets",
    .description = "balls at 200 to 1000 m/s at walls of 1 and 10 cm, rods at 100 rad/s between posts of 6 cm",
    .steps = 240,
    .view = {.color = ColorMode::Speed,
             .from = {-0.8f, 0.35f, 0.6f},
             .lower = {-10, 0, -12},
             .upper = {30, 3, 12},
             .picture = 0.008},
    .build = Build,
    .afterStep = DrawTrails,
    .accuracy = BallsBehindTheWalls,
    .accuracyMeaning = "balls behind the walls",
    .accuracyUnit = "balls",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::BulletsScene
