#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <cmath>

namespace fulcrum::TrapDoorScene {
namespace {

constexpr int kRemovedAt = 180;  // step: both stacks have slept for long
constexpr int kStacked = 5;
constexpr double kPillar = 2;  // m, its height

double StartHeight(int box) { return kPillar + 0.4 + 0.8 * box; }

// Two stacks on pillars; watched are the left pillar, the left stack, the right stack.
void Build(SceneWorld& world) {
    world.AddFloor(10, 10);
    const ShapePtr pillar = world.BoxOf(0.6f, static_cast<float>(kPillar / 2), 0.6f),
                   cube = world.BoxOf(0.4f, 0.4f, 0.4f);
    for (double x : {-1.5, 1.5}) {
        const BodyId support =
            world.Add({.shape = pillar, .motion = MotionType::Static, .position = {x, kPillar / 2, 0}});
        if (x < 0) world.watched.push_back(support);
    }
    for (double x : {-1.5, 1.5})
        for (int i = 0; i < kStacked; ++i)
            world.watched.push_back(world.Add({.shape = cube, .position = {x, StartHeight(i), 0}}));
}

void RemoveThePillar(SceneWorld& world, double) {
    if (world.StepCount() == kRemovedAt) (void)world.Bodies().Remove(world.watched[0]);
}

// The left stack must have fallen by about the pillar's height, and the right one must not have moved.
double Accuracy(const SceneWorld& world) {
    int wrong = 0;
    for (int i = 0; i < kStacked; ++i) {
        const BodyId left = world.watched[static_cast<size_t>(1 + i)];
        const BodyId right = world.watched[static_cast<size_t>(1 + kStacked + i)];
        if (!(world.Bodies().GetPose(left).position.y() < StartHeight(i) - 0.75 * kPillar)) ++wrong;
        if (world.Bodies().IsAwake(right) ||
            !(std::fabs(world.Bodies().GetPose(right).position.y() - StartHeight(i)) < 0.01))
            ++wrong;
    }
    return wrong;
}

}  // namespace

extern const Scene kScene{
    .name = "trap_door",
    .description = "two stacks sleep on pillars; one pillar vanishes: its stack wakes and falls, the other sleeps on",
    .steps = 360,
    .view = {.color = ColorMode::Awake, .picture = 0.62},
    .build = Build,
    .beforeStep = RemoveThePillar,
    .accuracy = Accuracy,
    .accuracyMeaning = "boxes that should have fallen and did not, or should have slept on and did not",
    .accuracyUnit = "boxes",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::TrapDoorScene
