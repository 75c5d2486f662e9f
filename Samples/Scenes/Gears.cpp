#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::GearsScene {
namespace {

constexpr float kSpeed = 6;                                 // rad/s of the first wheel
constexpr int kTeeth[] = {12, 36, 12, 48, 16, 64, 10, 30};  // two wheels an axle from the second on

ShapePtr WheelOf(SceneWorld& world, int teeth) {
    const double radius = 0.03 * teeth;
    std::vector<Vector3> rim;
    for (int i = 0; i < 16; ++i)
        for (const double z : {-0.05, 0.05})
            rim.push_back(Position(radius * Cos(2 * kPi * i / 16), radius * Sin(2 * kPi * i / 16), z).cast<float>());
    return world.HullOf(rim);
}

// A clockwork: each wheel drives a larger one, which turns the next small one on its own axle.
void Build(SceneWorld& world) {
    constexpr size_t kCount = std::size(kTeeth);
    const BodyId plate =
        world.Add({.shape = world.BoxOf(6, 2.5f, 0.02f), .motion = MotionType::Static, .position = {0, 3, -0.5}});
    Position center(-4.5, 2.5, 0);
    double height = 0;
    for (size_t i = 0; i < kCount; ++i) {
        const bool isOnTheSameAxle = i > 0 && i % 2 == 0;
        if (i % 2) center += Position(0.03 * (kTeeth[i - 1] + kTeeth[i]), 0, 0);
        if (isOnTheSameAxle) height += 0.2;
        const Position place = center + Position(0, 0, height);
        const BodyId wheel =
            world.Add({.shape = WheelOf(world, kTeeth[i]), .position = place, .density = 500, .layer = 1});
        // A wheel that is driven has a gap where its driver's tooth is, towards -x.
        const double pitch = 2 * kPi / kTeeth[i];
        world.Show(wheel, {.look = Look::Brass,
                           .teeth = kTeeth[i],
                           .toothAngle = i % 2 ? static_cast<float>(kPi + 0.5 * pitch) : 0.0f});
        world.watched.push_back(wheel);
        if (isOnTheSameAxle) {
            world.Join(JointOf<FixedJointSettings>(world.watched[i - 1], wheel, place));
            continue;
        }
        auto bearing = JointOf<HingeJointSettings>(plate, wheel, place, {0, 0, 1});
        if (i == 0) bearing.angle.motor = MotorToSpeed(kSpeed, 50);
        world.joints.push_back(world.Join(bearing));
        if (i == 0) continue;
        const BodyId driver = world.watched[i - 1];
        auto gear =
            JointOfTwo<GearJointSettings>(driver, wheel, world.Bodies().GetPose(driver).position, place, {0, 0, 1});
        gear.ratio = static_cast<float>(kTeeth[i]) / static_cast<float>(kTeeth[i - 1]);
        world.Join(gear);
    }
}

void NoContacts(SystemSettings& settings) { settings.layerCollides[1] &= ~2u; }

// Angles of two axles in a row differ by the ratio of their teeth.
double Accuracy(const SceneWorld& world) {
    double worst = 0;
    for (size_t axle = 1; axle < world.joints.size(); ++axle) {
        const double before = world.Joints().GetCoordinate(world.joints[axle - 1], JointAxis::AngularX);
        const double after = world.Joints().GetCoordinate(world.joints[axle], JointAxis::AngularX);
        // Coordinates without limits may be off by whole turns, which are whole teeth.
        const double off = before * kTeeth[2 * axle - 2] + after * kTeeth[2 * axle - 1];
        worst = std::max(worst, std::fabs(std::remainder(off, 2 * kPi)) / kTeeth[2 * axle - 2]);
    }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "gears",
    .description = "a clockwork of eight gears on five axles, 144 turns of the first for one of the last",
    .steps = 900,
    .sleeping = false,
    .view = {.color = ColorMode::Plain, .from = {0.12f, 0.1f, 1}, .picture = 0.3, .showsJoints = false},
    .adjust = NoContacts,
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest angle by which two gears are out of step, rad of the smaller one",
    .accuracyUnit = "rad",
    .accuracyRange = {{0, 0.002}},
};

}  // namespace fulcrum::GearsScene
