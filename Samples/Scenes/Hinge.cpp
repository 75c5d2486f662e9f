#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::HingeScene {
namespace {

constexpr int kSwing = 120;     // steps in which the first door is driven to one side
constexpr float kOpen = 1.2f;   // rad, its limits
constexpr float kFanSpeed = 8;  // rad/s
enum : size_t { kDriven, kFollowing, kRubbing, kSpringy, kFan };

JointId AddDoor(SceneWorld& world, double x, const AxisControl& angle, float speed) {
    const BodyId post =
        world.Add({.shape = world.BoxOf(0.05f, 1.1f, 0.05f), .motion = MotionType::Static, .position = {x, 1.1, 0}});
    const BodyId door = world.Add({.shape = world.BoxOf(0.5f, 1, 0.04f),
                                   .position = {x + 0.55, 1.1, 0},
                                   .linearVelocity = {0, 0, -0.55f * speed},
                                   .angularVelocity = {0, speed, 0},
                                   .mass = 20});
    auto hinge = JointOf<HingeJointSettings>(post, door, {x, 1.1, 0}, {0, 1, 0});
    hinge.angle = angle;
    return world.Join(hinge);
}

// Doors: driven between its limits, following a target, rubbing, thrown against soft stops; and a fan that nothing
// slows.
void Build(SceneWorld& world) {
    world.AddFloor(10, 4);
    AxisControl driven = Limited(-kOpen, kOpen), following, rubbing;
    following.motor = MotorToPosition(0, 4);
    rubbing.friction = 12;
    world.joints = {AddDoor(world, -6, driven, 0), AddDoor(world, -3, following, 0), AddDoor(world, 0, rubbing, 4),
                    AddDoor(world, 3, Limited(-0.5f, 0.5f, 1.5f, 0.2f), 3)};
    const BodyId hub = AddHook(world, {6.5, 1.5, 0});
    const BodyId blades = world.Add({.shape = world.BoxOf(1, 0.1f, 0.03f),
                                     .position = {6.5, 1.5, 0},
                                     .angularVelocity = {0, 0, kFanSpeed},
                                     .mass = 3});
    world.joints.push_back(world.Join(JointOf<HingeJointSettings>(hub, blades, {6.5, 1.5, 0}, {0, 0, 1})));
    world.watched = {blades};
}

void Drive(SceneWorld& world, double) {
    const float side = world.StepCount() / kSwing % 2 ? -1.0f : 1.0f;
    (void)world.Joints().SetMotor(world.joints[kDriven], JointAxis::AngularX, MotorToSpeed(3 * side, 200));
    (void)world.Joints().SetMotor(world.joints[kFollowing], JointAxis::AngularX,
                                  MotorToPosition(static_cast<float>(Sin(world.Time())), 4));
}

double Accuracy(const SceneWorld& world) {
    const double side = (world.StepCount() - 1) / kSwing % 2 ? -1 : 1;
    const double driven = world.Joints().GetCoordinate(world.joints[kDriven], JointAxis::AngularX);
    const double fan = double(world.Bodies().GetAngularVelocity(world.watched[0]).z()) - double(kFanSpeed);
    return std::max(
        {std::fabs(driven - side * double(kOpen)), std::fabs(fan) / double(kFanSpeed),
         double(Length(world.Bodies().GetAngularVelocity(world.Joints().GetBodyB(world.joints[kRubbing]))))});
}

}  // namespace

extern const Scene kScene{
    .name = "hinge",
    .description = "doors on hinges: driven between limits, following a target, with friction, soft stops; a fan",
    .steps = 480,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = Drive,
    .accuracy = Accuracy,
    .accuracyMeaning =
        "worst of: driven door off its limit, rad; fan's change of speed, parts; rubbing door's speed, rad/s",
    .accuracyUnit = "",
    .accuracyRange = {{0, 0.001}},
};

}  // namespace fulcrum::HingeScene
