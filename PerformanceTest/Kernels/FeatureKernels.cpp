// What a feature costs: a step of 1000 bodies, pairs or joints with it, per body, pair or joint, and the memory that it
// takes. Compare with the row that it builds on. Times, all taken in one run:
//   FulcrumKernels --benchmark_filter=Feature --benchmark_enable_random_interleaving --benchmark_repetitions=9
// Instructions, which repeat: 1e5 times those of one row (100 steps) are what this says
//   valgrind --tool=callgrind --toggle-collect='fulcrum::PhysicsSystem::Update(double)' FulcrumKernels
//       --benchmark_filter=Feature/joint:ball$
#include <Fulcrum/Fulcrum.h>

#include <benchmark/benchmark.h>

#include <functional>

namespace fulcrum {
namespace {

constexpr int kCount = 1000, kRow = 40, kUntimed = 30, kTimed = 70;
constexpr double kStep = 1.0 / 60, kApart = 3;

class Listener final : public ContactListener {};

// What a row of the table builds: each member but `base` is left out where it makes no difference.
struct Feature {
    const char* name;
    std::function<void(SystemSettings&)> world = [](SystemSettings&) {};
    std::function<void(BodySettings&)> body = [](BodySettings&) {};
    bool isOnFloor = false;
    // Beside each body, made by the same settings, and what joins them; null: nothing.
    std::function<void(PhysicsSystem&, BodyId, BodySettings)> beside = nullptr;
    bool listens = false;
};

template <class Settings>
std::function<void(PhysicsSystem&, BodyId, BodySettings)> Joined(std::function<void(Settings&)> change = [](Settings&) {
}) {
    return [change](PhysicsSystem& system, BodyId id, BodySettings body) {
        body.position += Position(1.2, 0, 0);
        Settings settings;
        settings.bodyA = id;
        settings.bodyB = system.Bodies().Create(body).Value();
        settings.anchorA.point = body.position - Position(0.6, 0, 0);
        change(settings);
        (void)system.Joints().Create(settings).Value();
    };
}

void Beside(PhysicsSystem& system, BodyId, BodySettings body, double distance) {
    body.position += Position(distance, 0, 0);
    (void)system.Bodies().Create(body).Value();
}

void Float(SystemSettings& settings) { settings.gravity = Vector3::Zero(); }

std::vector<Feature> Features() {
    const auto floating = [](const char* name, std::function<void(BodySettings&)> body) {
        return Feature{.name = name, .world = Float, .body = std::move(body)};
    };
    const auto resting = [](
                             const char* name, std::function<void(BodySettings&)> body,
                             std::function<void(SystemSettings&)> world = [](SystemSettings&) {}) {
        return Feature{.name = name, .world = std::move(world), .body = std::move(body), .isOnFloor = true};
    };
    const auto jointed = [](const char* name, std::function<void(PhysicsSystem&, BodyId, BodySettings)> beside,
                            std::function<void(SystemSettings&)> world = Float) {
        return Feature{.name = name, .world = std::move(world), .beside = std::move(beside)};
    };
    const auto none = [](BodySettings&) {};
    std::vector<Feature> features{
        {.name = "body:asleep", .body = [](BodySettings& s) { s.startAsleep = true; }},
        floating("body:floats", none),
        floating("body:turns", [](BodySettings& s) { s.angularVelocity = Vector3(1, 2, 0.5f); }),
        floating("body:kinematic",
                 [](BodySettings& s) { s.motion = MotionType::Kinematic, s.linearVelocity = Vector3(0, 0.01f, 0); }),
        floating("body:damped", [](BodySettings& s) { s.linearDamping = s.angularDamping = 0.1f; }),
        floating("body:locked_axes", [](BodySettings& s) { s.lockedAxes = LockedAxes::RotationX; }),
        floating("body:filtered", [](BodySettings& s) { s.category = 2; }),
        floating("body:continuous", [](BodySettings& s) { s.continuous = ContinuousCollision::LinearAndAngular; }),
        floating("body:sensor", [](BodySettings& s) { s.isSensor = true; }),
        resting("contact:rests", none),
        resting("contact:no_friction",
                [](BodySettings& s) { s.material = {.friction = 0, .frictionRule = CombineRule::Minimum}; }),
        resting("contact:restitution", [](BodySettings& s) { s.material.restitution = 0.5f; }),
        resting("contact:own_target", [](BodySettings& s) { s.penetrationTarget = 0.004f; }),
        resting("contact:no_target", none,
                [](SystemSettings& s) { s.accuracy.penetration = std::numeric_limits<float>::infinity(); }),
        resting("contact:events", none, [](SystemSettings& s) { s.events.contacts = true; }),
        resting("contact:body_events", none, [](SystemSettings& s) { s.events.bodies = true; }),
        resting("contact:measures_errors", none, [](SystemSettings& s) { s.measuresErrors = true; }),
        resting("contact:libccd", none, [](SystemSettings& s) { s.narrowPhase = NarrowPhaseMethod::Libccd; }),
        {.name = "contact:listener", .isOnFloor = true, .listens = true},
        {.name = "pair:near",
         .world = Float,
         .beside = [](PhysicsSystem& s, BodyId id, BodySettings b) { Beside(s, id, b, 1.07); }},
        {.name = "pair:apart",
         .world = Float,
         .beside = [](PhysicsSystem& s, BodyId id, BodySettings b) { Beside(s, id, b, 1.5); }},
        jointed("joint:ball", Joined<PointJointSettings>()),
        jointed("joint:ball_breakable", Joined<PointJointSettings>([](auto& s) { s.breakForce = 1e9f; })),
        jointed("joint:ball_target", Joined<PointJointSettings>([](auto& s) { s.errorTarget = 0.001f; })),
        jointed("joint:ball_mass_override",
                Joined<PointJointSettings>([](auto& s) { s.massOverride.inverseMassScaleA = 0.5f; })),
        jointed("joint:fixed", Joined<FixedJointSettings>()),
        jointed("joint:hinge", Joined<HingeJointSettings>()),
        jointed("joint:hinge_motor", Joined<HingeJointSettings>([](auto& s) {
                    s.angle.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 0.1f};
                })),
        jointed("joint:slider", Joined<SliderJointSettings>()),
        jointed("joint:distance", Joined<DistanceJointSettings>()),
        jointed("joint:cone", Joined<ConeJointSettings>()),
        jointed("joint:swing_twist", Joined<SwingTwistJointSettings>()),
        jointed("joint:six_dof", Joined<SixDofJointSettings>()),
    };
    return features;
}

std::unique_ptr<PhysicsSystem> Build(const Feature& feature, const ContactListener* listener) {
    SystemSettings settings;
    settings.sleep.enabled = false;
    feature.world(settings);
    std::unique_ptr<PhysicsSystem> system = PhysicsSystem::Create(settings).Value();
    if (feature.listens) system->SetContactListener(listener);
    if (feature.isOnFloor)
        (void)system->Bodies()
            .Create({.shape = Box::Create(Vector3(200, 1, 200)).Value(),
                     .motion = MotionType::Static,
                     .position = {50, -1.5, 50}})
            .Value();
    const ShapePtr shape = Box::Create(Vector3(0.5f, 0.5f, 0.5f)).Value();
    for (int i = 0; i < kCount; ++i) {
        BodySettings body{.shape = shape, .position = {kApart * (i % kRow), 0, kApart * (i / kRow)}};
        feature.body(body);
        const BodyId id = system->Bodies().Create(body).Value();
        if (feature.beside) feature.beside(*system, id, body);
    }
    return system;
}

void Step(benchmark::State& state, const Feature& feature) {
    const Listener listener;
    const auto system = Build(feature, &listener);
    for (int i = 0; i < kUntimed; ++i) (void)system->Update(kStep);
    double ms = 0;
    for (auto unused : state) {
        (void)unused;
        (void)system->Update(kStep);
        ms += system->Report().totalMs;
    }
    state.counters["ns"] = 1e6 * ms / static_cast<double>(state.iterations()) / kCount;
    state.counters["bytes"] = static_cast<double>(system->MemoryUsed()) / kCount;
}

[[maybe_unused]] const bool kRegistered = [] {
    for (const Feature& feature : Features())
        benchmark::RegisterBenchmark((std::string("Feature/") + feature.name).c_str(), [feature](
                                                                                           benchmark::State& state) {
            Step(state, feature);
        })->Iterations(kTimed);
    return true;
}();

}  // namespace
}  // namespace fulcrum
