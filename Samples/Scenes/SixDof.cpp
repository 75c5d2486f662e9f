#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::SixDofScene {
namespace {

constexpr double kRate = 1.5;     // rad/s of the stage's circle
constexpr double kFrequency = 2;  // Hz, of the table's springs
enum : size_t { kStage, kTable, kBox };

SixDofJointSettings Settings(BodyId a, BodyId b, const Position& point) {
    auto settings = JointOf<SixDofJointSettings>(a, b, point);
    settings.anchorA.normal = Vector3(0, 1, 0);
    for (AxisControl& axis : settings.axes) axis = kLockedAxis;
    return settings;
}

// A stage that motors carry about in a circle, a table on springs in every axis with a weight on it, a box loose in a
// box.
void Build(SceneWorld& world) {
    world.AddFloor(10, 4);
    const BodyId stage = world.Add({.shape = world.BoxOf(0.6f, 0.1f, 0.6f), .position = {-5, 1.5, 0}, .mass = 20});
    auto xz = Settings(AddHook(world, {-5, 1.5, 0}), stage, {-5, 1.5, 0});
    xz[JointAxis::LinearX] = Limited(-1, 1);
    xz[JointAxis::LinearZ] = Limited(-1, 1);
    world.joints.push_back(world.Join(xz));
    world.watched.push_back(stage);

    const BodyId table = world.Add({.shape = world.BoxOf(0.8f, 0.1f, 0.8f), .position = {0, 1.5, 0}, .mass = 20});
    auto soft = Settings(AddHook(world, {0, 1, 0}), table, {0, 1.5, 0});
    for (AxisControl& axis : soft.axes) axis = Limited(0, 0, kFrequency, 1);
    world.joints.push_back(world.Join(soft));
    world.Add({.shape = world.BoxOf(0.2f, 0.2f, 0.2f), .position = {0, 1.81, 0}, .mass = 20});

    const BodyId loose = world.Add({.shape = world.BoxOf(0.3f, 0.3f, 0.3f),
                                    .position = {5, 2, 0},
                                    .linearVelocity = {4, 2, 3},
                                    .angularVelocity = {2, 3, 4},
                                    .mass = 10});
    auto within = Settings(AddHook(world, {5, 2, 0}), loose, {5, 2, 0});
    for (AxisControl& axis : within.axes) axis = Limited(-0.5f, 0.5f);
    world.joints.push_back(world.Join(within));
}

void Drive(SceneWorld& world, double dt) {
    const double turned = kRate * (world.Time() + dt);
    (void)world.Joints().SetMotor(world.joints[kStage], JointAxis::LinearX,
                                  MotorToPosition(static_cast<float>(0.8 * Cos(turned)), 15));
    (void)world.Joints().SetMotor(world.joints[kStage], JointAxis::LinearZ,
                                  MotorToPosition(static_cast<float>(0.8 * Sin(turned)), 15));
}

// The stage lags by about 2 zeta / w = 0.02 s; its distance from the circle does not depend on the lag.
double Accuracy(const SceneWorld& world) {
    const Position stage = world.Bodies().GetPose(world.watched[0]).position - Position(-5, 1.5, 0);
    double worst = std::fabs(std::hypot(stage.x(), stage.z()) - 0.8);
    for (int axis = 0; axis < 3; ++axis)
        worst = std::max(
            worst, std::fabs(world.Joints().GetCoordinate(world.joints[kBox], static_cast<JointAxis>(axis))) - 0.5);
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "six_dof",
    .description = "joints of six axes: a stage driven in a circle, a table on springs, a box loose within limits",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = Drive,
    .accuracy = Accuracy,
    .accuracyMeaning = "stage off its circle, or the box beyond a limit",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::SixDofScene
