#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::ConeScene {
namespace {

constexpr double kAngles[] = {0, 15, 45, 90, 150, 180};  // degrees

// Clubs in sockets of different width, thrown sideways, spin and wobble about.
void Build(SceneWorld& world) {
    world.AddFloor(12, 4);
    double x = -6;
    for (const double angle : kAngles) {
        const Position socket(x, 3, 0);
        const BodyId club = world.Add({.shape = world.CapsuleOf(0.6f, 0.15f),
                                       .position = socket - Position(0, 0.8, 0),
                                       .linearVelocity = {2, 0, 3},
                                       .angularVelocity = {0, 6, 0},
                                       .mass = 10});
        auto cone = JointOf<ConeJointSettings>(AddHook(world, socket), club, socket, {0, -1, 0});
        cone.halfAngle = static_cast<float>(angle * kDegree);
        world.joints.push_back(world.Join(cone));
        x += 2.4;
    }
}

double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t i = 0; i < world.joints.size(); ++i)
        worst =
            std::max(worst, world.Joints().GetCoordinate(world.joints[i], JointAxis::AngularY) - kAngles[i] * kDegree);
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "cone",
    .description = "clubs thrown about in cones of 0, 15, 45, 90, 150 and 180 degrees",
    .steps = 300,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest angle beyond a cone",
    .accuracyUnit = "rad",
    .accuracyRange = {{0, 0.001}},
};

}  // namespace fulcrum::ConeScene
