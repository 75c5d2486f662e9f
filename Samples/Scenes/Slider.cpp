#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::SliderScene {
namespace {

constexpr int kLift = 180;      // steps up, and as many down
constexpr float kTop = 2;       // m, its upper limit
constexpr double kSlope = 0.5;  // rad
enum : size_t { kElevator, kHeld, kSliding };

// An elevator with freight between its limits, two carts on a slope of which friction holds one, and a weight on a soft
// stop.
void Build(SceneWorld& world) {
    world.AddFloor(10, 6);
    const BodyId shaft = AddHook(world, {-4, 3, -1.5});
    const BodyId cabin = world.Add({.shape = world.BoxOf(0.8f, 0.1f, 0.8f), .position = {-4, 0.2, 0}, .mass = 100});
    auto elevator = JointOf<SliderJointSettings>(shaft, cabin, {-4, 0.2, 0}, {0, 1, 0});
    elevator.slide = Limited(0, kTop);
    world.joints.push_back(world.Join(elevator));
    for (int i = 0; i < 3; ++i)
        world.Add({.shape = world.BoxOf(0.25f, 0.25f, 0.25f), .position = {-4, 0.55 + 0.5 * i, 0}, .mass = 20});

    const Vector3 down(static_cast<float>(Cos(kSlope)), static_cast<float>(-Sin(kSlope)), 0);
    for (const float friction : {60.0f, 30.0f}) {  // 10 kg on the slope: 47 N
        const Position place(0, 3, friction > 50 ? -1 : 1);
        const BodyId cart = world.Add({.shape = world.BoxOf(0.3f, 0.15f, 0.2f),
                                       .position = place,
                                       .rotation = RotationAbout({0, 0, 1}, -kSlope),
                                       .mass = 10});
        auto rail = JointOf<SliderJointSettings>(AddHook(world, place), cart, place, down);
        rail.slide = Limited(0, 3);
        rail.slide.friction = friction;
        world.joints.push_back(world.Join(rail));
    }

    const BodyId weight = world.Add({.shape = world.SphereOf(0.3f), .position = {5, 3, 0}, .mass = 10});
    auto bouncing = JointOf<SliderJointSettings>(AddHook(world, {5, 3.5, 0}), weight, {5, 3, 0}, {0, 1, 0});
    bouncing.slide = Limited(-1, 1, 1.5f, 0.1f);
    world.joints.push_back(world.Join(bouncing));
}

void Drive(SceneWorld& world, double) {
    const float speed = world.StepCount() / kLift % 2 ? -1.0f : 1.0f;
    (void)world.Joints().SetMotor(world.joints[kElevator], JointAxis::LinearX, MotorToSpeed(speed, 4000));
}

double Accuracy(const SceneWorld& world) {
    const auto place = [&](size_t joint) {
        return world.Joints().GetCoordinate(world.joints[joint], JointAxis::LinearX);
    };
    const double end = (world.StepCount() - 1) / kLift % 2 ? 0 : double(kTop);
    return std::max({std::fabs(place(kElevator) - end), std::fabs(place(kHeld)), std::fabs(place(kSliding) - 3)});
}

}  // namespace

extern const Scene kScene{
    .name = "slider",
    .description = "sliders: an elevator with freight, two carts on a slope of which friction holds one, a soft stop",
    .steps = 540,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = Drive,
    .accuracy = Accuracy,
    .accuracyMeaning = "how far the elevator, the cart that holds and the cart that slides are from where they belong",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.001}},
};

}  // namespace fulcrum::SliderScene
