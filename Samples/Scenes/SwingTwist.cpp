#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::SwingTwistScene {
namespace {

constexpr int kPoses = 3, kHold = 180;  // steps for each pose
constexpr size_t kDriven = 0;

// Targets of the driven arm, against the pose in which it points along x.
Quaternion TargetOf(int step) {
    const Quaternion targets[kPoses] = {RotationAbout({0, 0, 1}, 0.8),
                                        RotationAbout({0, 1, 0}, -0.7) * RotationAbout({1, 0, 0}, 0.5),
                                        RotationAbout({0, 0, 1}, -0.6) * RotationAbout({1, 0, 0}, -0.5)};
    return targets[step / kHold % kPoses];
}

JointId AddArm(SceneWorld& world, double x, const AxisControl& twist, const AxisControl& swingY,
               const AxisControl& swingZ, SwingShape shape) {
    const Position shoulder(x, 3, 0);
    const BodyId arm =
        world.Add({.shape = world.BoxOf(0.6f, 0.15f, 0.1f), .position = shoulder + Position(0.7, 0, 0), .mass = 5});
    auto settings = JointOf<SwingTwistJointSettings>(AddHook(world, shoulder), arm, shoulder);
    settings.anchorA.normal = Vector3(0, 1, 0);
    settings.twist = twist;
    settings.swingY = swingY;
    settings.swingZ = swingZ;
    settings.shape = shape;
    return world.Join(settings);
}

// An arm that is driven from pose to pose, one that falls in an ellipse, one in a pyramid, one that friction brakes.
void Build(SceneWorld& world) {
    world.AddFloor(10, 4);
    AxisControl driven = Limited(-1, 1), rubbing;
    driven.motor = MotorToPosition(0, 6);
    rubbing.friction = 5;
    const AxisControl narrow = Limited(-0.4f, 0.4f), wide = Limited(-1, 1);
    world.joints = {AddArm(world, -6, driven, driven, driven, SwingShape::Ellipse),
                    AddArm(world, -2, narrow, narrow, wide, SwingShape::Ellipse),
                    AddArm(world, 2, narrow, wide, narrow, SwingShape::Pyramid),
                    AddArm(world, 6, rubbing, rubbing, rubbing, SwingShape::Ellipse)};
    for (const JointId id : world.joints)
        (void)world.Bodies().SetVelocity(world.Joints().GetBodyB(id), {0, 0, -2}, {4, 3, 0});
}

void Drive(SceneWorld& world, double) {
    (void)world.Joints().SetTargetOrientation(world.joints[kDriven], TargetOf(world.StepCount()));
}

// A motor of frequency f carries the arm's weight some degrees too low; twist limits are met exactly.
double Accuracy(const SceneWorld& world) {
    const Quaternion left = TargetOf(world.StepCount() - 1).Conjugate() *
                            world.Bodies().GetPose(world.Joints().GetBodyB(world.joints[kDriven])).rotation;
    double worst = 2 * std::sqrt(double(left.x * left.x + left.y * left.y + left.z * left.z));
    for (size_t i = 1; i < 3; ++i)
        worst = std::max(worst,
                         std::fabs(world.Joints().GetCoordinate(world.joints[i], JointAxis::AngularX)) - double(0.4f));
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "swing_twist",
    .description = "arms in shoulders: driven from pose to pose, falling in an ellipse and in a pyramid, braked",
    .steps = 540,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = Drive,
    .accuracy = Accuracy,
    .accuracyMeaning = "driven arm off its pose (its weight alone: 0.01 or so), or a twist beyond its limit",
    .accuracyUnit = "rad",
    .accuracyRange = {{0, 0.02}},
};

}  // namespace fulcrum::SwingTwistScene
