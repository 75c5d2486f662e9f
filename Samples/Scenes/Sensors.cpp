#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::SensorsScene {
namespace {

// The bodies in the order of `watched`, after the four sensors.
enum SensorName : size_t { kField, kGate, kScanner, kTarget, kSensors };
constexpr size_t kFloating = 6, kRolling = 8, kSleeping = 5, kBullets = 4;
constexpr size_t kFirstRolling = kSensors + kFloating, kFirstSleeping = kFirstRolling + kRolling,
                 kFirstBullet = kFirstSleeping + kSleeping;
constexpr float kLift = 3;           // times the weight, in the field
constexpr float kBulletSpeed = 800;  // m/s: 13 m a step
constexpr double kSleepersAt = 6;    // m, z

void AddSensor(SceneWorld& world, const ShapePtr& shape, const Position& position,
               const Vector3& velocity = Vector3::Zero()) {
    BodySettings settings{.shape = shape,
                          .motion = velocity.isZero(0) ? MotionType::Static : MotionType::Kinematic,
                          .position = position};
    settings.linearVelocity = velocity;
    settings.isSensor = true;
    settings.sensorReportsStay = false;
    world.watched.push_back(world.Add(settings));
}

void Build(SceneWorld& world) {
    world.AddFloor(20, 20);
    AddSensor(world, world.BoxOf(4, 1, 1), {0, 1, -6});
    AddSensor(world, world.BoxOf(0.05f, 1.5f, 2), {0, 1.5, 0});
    AddSensor(world, world.BoxOf(0.1f, 1, 1), {-7, 1, kSleepersAt}, {3, 0, 0});
    AddSensor(world, world.BoxOf(0.005f, 1, 2), {0, 8, 0});

    const ShapePtr crate = world.BoxOf(0.3f, 0.3f, 0.3f), ball = world.SphereOf(0.3f), bullet = world.SphereOf(0.05f);
    for (size_t i = 0; i < kFloating; ++i) {
        const double k = static_cast<double>(i);
        world.watched.push_back(
            world.Add({.shape = crate, .position = {1.2 * k - 3, 3 + 0.2 * k, -6}, .linearDamping = 0.5f}));
    }
    for (size_t i = 0; i < kRolling; ++i)
        world.watched.push_back(world.Add({.shape = ball,
                                           .position = {-3 - 0.7 * static_cast<double>(i), 0.3, 0},
                                           .linearVelocity = {4, 0, 0},
                                           .angularVelocity = {0, 0, -4 / 0.3f}}));
    for (size_t i = 0; i < kSleeping; ++i)
        world.watched.push_back(world.Add(
            {.shape = crate, .position = {2.5 * static_cast<double>(i) - 5, 0.3, kSleepersAt}, .startAsleep = true}));
    for (size_t i = 0; i < kBullets; ++i) {
        const double k = static_cast<double>(i);
        world.watched.push_back(world.Add({.shape = bullet,
                                           .position = {-1 - 14 * k, 8, 0.4 * k - 0.6},
                                           .linearVelocity = {kBulletSpeed, 0, 0},
                                           .gravityFactor = 0}));
    }
}

// The field lifts bodies inside it, the gate removes bodies that have passed it, the scanner kicks bodies aside, the
// target catches bullets.
void React(SceneWorld& world, double) {
    BodyInterface& bodies = world.Bodies();
    for (const BodyId id : world.System().BodiesInside(world.watched[kField]))
        (void)bodies.AddForce(id, world.System().Settings().gravity * (-kLift * bodies.GetMass(id)));
    for (const SensorEvent& e : world.System().SensorEvents()) {
        const bool begins = e.kind == SensorEvent::Kind::Begin;
        if (e.sensor == world.watched[kGate] && !begins) (void)bodies.Remove(e.body);
        if (e.sensor == world.watched[kTarget] && begins) (void)bodies.Remove(e.body);
        if (e.sensor == world.watched[kScanner] && begins) (void)bodies.SetVelocity(e.body, {0, 2, 2}, {0, 0, 0});
    }
}

double Accuracy(const SceneWorld& world) {
    const BodyInterface& bodies = world.Bodies();
    int wrong = 0;
    for (size_t i = kSensors; i < world.watched.size(); ++i) {
        const BodyId id = world.watched[i];
        const Position at = bodies.GetPose(id).position;
        if (i < kFirstRolling) wrong += !(at.y() > 0.5);
        else if (i < kFirstSleeping) wrong += bodies.Exists(id);
        else if (i < kFirstBullet) wrong += !(at.z() > kSleepersAt + 0.3);
        else wrong += bodies.Exists(id);
    }
    return wrong;
}

}  // namespace

extern const Scene kScene{
    .name = "sensors",
    .description =
        "a force field, a gate that takes balls away, a scanner that kicks sleepers, a thin target for bullets",
    .view = {.color = ColorMode::Plain},
    .build = Build,
    .beforeStep = React,
    .accuracy = Accuracy,
    .accuracyMeaning = "crates not held up, balls and bullets not caught, sleepers not found",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::SensorsScene
