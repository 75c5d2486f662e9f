#include <Fulcrum/Samples/Scenes/JointShorthands.h>

namespace fulcrum::OverconstrainedDoorScene {
namespace {

constexpr double kAskew = 0.01;  // m: how far the middle hinge is out of line

// A door on three hinges of which the middle one is out of line, and is hit by a ball; the right one beside it.
void Build(SceneWorld& world) {
    world.AddFloor(8, 8);
    for (const double askew : {kAskew, 0.0}) {
        const double x = askew > 0 ? -2 : 2;
        const BodyId frame =
            world.Add({.shape = world.BoxOf(0.1f, 1.1f, 0.1f), .motion = MotionType::Static, .position = {x, 1.1, 0}});
        const BodyId door =
            world.Add({.shape = world.BoxOf(0.6f, 1, 0.05f), .position = {x + 0.75, 1.1, 0}, .mass = 30});
        for (const double y : {0.3, 1.1, 1.9}) {
            const Position place(x + 0.1, y, 0);
            world.Join(JointOfTwo<HingeJointSettings>(frame, door, place + Position(0, 0, y == 1.1 ? askew : 0), place,
                                                      {0, 1, 0}));
        }
        world.Add(
            {.shape = world.SphereOf(0.2f), .position = {x + 1.1, 1.3, 3}, .linearVelocity = {0, 1, -8}, .mass = 5});
    }
}

}  // namespace

extern const Scene kScene{
    .name = "overconstrained_door",
    .description = "doors on three hinges, the middle one of the first 1 cm out of line, each hit by a ball",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .accuracy = LargestJointGap,
    .accuracyMeaning =
        "largest distance between the two anchors of a joint, m; a third of a centimeter cannot be helped",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.01}},
};

}  // namespace fulcrum::OverconstrainedDoorScene
