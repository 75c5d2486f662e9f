#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <cmath>

namespace fulcrum::WheelScene {
namespace {

constexpr float kRadius = 0.4f;  // m, of the wheels
constexpr double kSpeed = 5;     // m/s
constexpr int kStraight = 360;   // steps of slalom before it drives straight on

// A rig of four sprung wheels, of which the front ones steer and the rear ones drive, over sleepers and in a slalom.
void Build(SceneWorld& world) {
    world.Add({.shape = world.BoxOf(60, 1, 20),
               .motion = MotionType::Static,
               .position = {40, -1, 0},
               .material = {.friction = 1}});
    for (int i = 0; i < 6; ++i)
        world.Add({.shape = world.CapsuleOf(1.5f, 0.05f),
                   .motion = MotionType::Static,
                   .position = {4.0 + 1.5 * i, 0, i % 2 ? 1.2 : -1.2},
                   .rotation = RotationAbout({1, 0, 0}, kPi / 2)});
    const BodyId chassis = world.Add({.shape = world.BoxOf(1.6f, 0.25f, 0.7f), .position = {0, 0.75, 0}, .mass = 600});
    world.watched.push_back(chassis);
    const ShapePtr wheel = world.SphereOf(kRadius);
    for (const double x : {1.2, -1.2})
        for (const double z : {0.9, -0.9}) {
            const Position axle(x, kRadius, z);
            const BodyId body = world.Add({.shape = wheel, .position = axle, .mass = 20, .material = {.friction = 1}});
            // It spins about -z: forwards is +x.
            auto settings = JointOf<WheelJointSettings>(chassis, body, axle, {0, 0, -1});
            settings.anchorA.normal = Vector3(0, 1, 0);
            settings.isSteered = x > 0;
            settings.steering.motor = MotorToPosition(0, 8);
            if (x < 0) settings.spin.motor = MotorToSpeed(static_cast<float>(kSpeed / double(kRadius)), 400);
            world.joints.push_back(world.Join(settings));
        }
}

void Steer(SceneWorld& world, double) {
    const double angle = world.StepCount() < kStraight ? 0.25 * Sin(1.5 * world.Time()) : 0;
    for (size_t i = 0; i < 2; ++i)
        (void)world.Joints().SetMotor(world.joints[i], JointAxis::AngularY,
                                      MotorToPosition(static_cast<float>(angle), 8));
}

double Accuracy(const SceneWorld& world) {
    const Vector3 v = world.Bodies().GetLinearVelocity(world.watched[0]);
    const Vector3 up = Rotate(world.Bodies().GetPose(world.watched[0]).rotation, Vector3(0, 1, 0));
    return up.y() < 0.9f ? 1 : std::fabs(double(Length(v)) / kSpeed - 1);
}

}  // namespace

extern const Scene kScene{
    .name = "wheel",
    .description = "a rig on four sprung wheels, steered by the front and driven by the rear ones, over sleepers",
    .steps = 540,
    .sleeping = false,
    .view = {.color = ColorMode::Plain,
             .from = {0.7f, 0.45f, 1},
             .lower = {-4, 0, -2.5},
             .upper = {4, 2, 2.5},
             .picture = 0.3,
             .showsJoints = false,
             .follows = 0},
    .build = Build,
    .beforeStep = Steer,
    .accuracy = Accuracy,
    .accuracyMeaning = "how far its speed is from that of its wheels; 1 where it fell over",
    .accuracyUnit = "parts",
    .accuracyRange = {{0, 0.02}},
};

}  // namespace fulcrum::WheelScene
