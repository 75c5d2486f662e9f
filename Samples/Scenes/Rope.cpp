#include <Fulcrum/Samples/Scenes/JointShorthands.h>

namespace fulcrum::RopeScene {
namespace {

constexpr int kLinks = 40;

// A rope of capsules with a box at its end swings over a bar and back.
void Build(SceneWorld& world) {
    world.AddFloor(12, 6);
    world.Add({.shape = world.CapsuleOf(1, 0.5f),
               .motion = MotionType::Static,
               .position = {-1, 5, 0},
               .rotation = RotationAbout({1, 0, 0}, kPi / 2)});
    const ShapePtr link = world.CapsuleOf(0.07f, 0.05f);
    BodyId last = AddHook(world, {0, 9, 0});
    for (int i = 0; i < kLinks; ++i) {
        const double x = 0.2 * i;
        const BodyId next = world.Add(
            {.shape = link, .position = {x + 0.1, 9, 0}, .rotation = RotationAbout({0, 0, 1}, kPi / 2), .mass = 0.5f});
        world.Join(JointOf<PointJointSettings>(last, next, {x, 9, 0}));
        last = next;
    }
    const BodyId box =
        world.Add({.shape = world.BoxOf(0.2f, 0.2f, 0.2f), .position = {0.2 * kLinks + 0.2, 9, 0}, .mass = 5});
    world.Join(JointOf<PointJointSettings>(last, box, {0.2 * kLinks, 9, 0}));
}

}  // namespace

extern const Scene kScene{
    .name = "rope",
    .description = "a rope of 40 capsules with a box at its end, swung against a bar",
    .steps = 480,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.35f, 0.1f, 1}, .picture = 0.25, .showsJoints = false},
    .build = Build,
    .accuracy = LargestJointGap,
    .accuracyMeaning = "largest distance between the two anchors of a joint",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::RopeScene
