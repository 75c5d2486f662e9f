// Springs, motors, gears and pulleys, and the momentum of jointed bodies.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kJoints{.joints = true};

// x(t) = x0 exp(-zeta w t) (cos w_d t + zeta w / w_d sin w_d t), w_d = w sqrt(1 - zeta^2). The rest length is 20 m, so
// that the distance never is 0. The effective frequency is that of the crossings; the damping ratio that of the decay
// from peak to peak, with peaks from parabolas.
void Spring(LabRun& run) {
    constexpr double kFrequency = 2, kDamping = 0.1, kRest = 20;
    const double start = run.parameter;
    LabWorld world(run, kNoGravity);
    const BodyId ball = world.Add({.shape = SphereOf(0.5), .position = {kRest + start, 0, 0}, .mass = 1});
    auto joint = JointOfTwo<DistanceJointSettings>(AddHook(world), ball, {0, 0, 0}, {kRest + start, 0, 0});
    joint.minDistance = joint.maxDistance = static_cast<float>(kRest);
    joint.spring = {.frequency = static_cast<float>(kFrequency), .dampingRatio = static_cast<float>(kDamping)};
    world.Join(joint);

    const double w = 2 * kPi * kFrequency, wd = w * std::sqrt(1 - kDamping * kDamping);
    double largest = 0;
    Crossings crossings;
    std::vector<double> peaks;
    double x0 = start, x1 = start;
    crossings.Sample(0, start);
    for (int i = run.Steps(3); i > 0; --i) {
        world.Step();
        const double t = world.Time(), x = world.At(ball).x() - kRest;
        const double reference =
            start * std::exp(-kDamping * w * t) * (std::cos(wd * t) + kDamping * w / wd * std::sin(wd * t));
        largest = std::max(largest, std::abs(x - reference));
        crossings.Sample(t, x);
        if (std::abs(x1) > std::abs(x0) && std::abs(x1) >= std::abs(x)) {
            const double slope = (x - x0) / 2, bend = x - 2 * x1 + x0;
            peaks.push_back(std::abs(x1 - slope * slope / (2 * bend)));
        }
        x0 = x1;
        x1 = x;
        if (i % std::max(1, run.setting.rate / 30) == 0) run.Observe(x / start);
    }
    const double frequency = crossings.Period() ? 1 / *crossings.Period() : 0;
    double damping = 0;
    if (peaks.size() >= 2 && peaks.back() > 0) {
        const double decay = std::log(peaks.front() / peaks.back()) / static_cast<double>(peaks.size() - 1);
        damping = decay / std::sqrt(decay * decay + kPi * kPi);  // half a period from peak to peak
    }
    run.Error("motion", largest / start);
    run.Error("frequency", Relative(frequency, wd / (2 * kPi)));
    run.Error("damping_ratio", Relative(damping, kDamping));
    run.Figure("effective_frequency_hz", frequency);
    run.Figure("effective_damping_ratio", damping);
}

BodyId AddSlide(LabWorld& world, double speed, const AxisControl& control) {
    const BodyId sled =
        world.Add({.shape = BoxOf(1, 1, 1), .linearVelocity = {static_cast<float>(speed), 0, 0}, .mass = 8000});
    SliderJointSettings joint = JointOf<SliderJointSettings>(AddHook(world), sled, {0, 0, 0});
    joint.slide = control;
    world.Join(joint);
    return sled;
}

// 16000 N on 8000 kg are 2 m/s2: v(1) = 2 m/s, and the target of 3 m/s from 1.5 s on.
void Motor(LabRun& run) {
    LabWorld world(run);
    AxisControl control;
    control.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 3, .minForce = -16000, .maxForce = 16000};
    const BodyId sled = AddSlide(world, 0, control);
    world.Steps(1);
    const double first = world.Speed(sled).x();
    world.Steps(1);
    const double second = world.Speed(sled).x();
    run.Error("speed", std::max(std::abs(first - 2), std::abs(second - 3)) / 3);
    run.Error("way", Relative(world.At(sled).x(), 0.5 * 2 * 1.5 * 1.5 + 3 * 0.5));
    run.Observe(first / 3);
    run.Observe(world.At(sled).x() / 3.75);
}

// Friction of 16000 N from 10 m/s: v(2) = 6 m/s.
void Brake(LabRun& run) {
    LabWorld world(run);
    AxisControl control;
    control.friction = 16000;
    const BodyId sled = AddSlide(world, 10, control);
    world.Steps(2);
    run.Error("speed", std::abs(world.Speed(sled).x() - 6) / 10);
    run.Error("way", Relative(world.At(sled).x(), 10 * 2 - 0.5 * 2 * 4));
    run.Observe(world.Speed(sled).x() / 10);
}

// Discs with 100 and 400 teeth; the big one turns at 3 rad/s as they are meshed. With w1 = -4 w2 the impulse J at the
// teeth gives I2 (w2' - 3) = -4 J and I1 w1 = -J: w2' = 3 I2 / (I2 + 16 I1). Discs of one thickness: I2 = 256 I1.
void Gears(LabRun& run) {
    LabWorld world(run, kNoGravity);
    const BodyId hook = AddHook(world);
    const auto addDisc = [&](double x, double radius, double spin) {
        const BodyId disc = world.Add({.shape = Cylinder::Create(0.05f, static_cast<float>(radius)).Value(),
                                       .position = {x, 0, 0},
                                       .rotation = RotationAbout({1, 0, 0}, kPi / 2),  // its axis along z
                                       .angularVelocity = {0, 0, static_cast<float>(spin)},
                                       .mask = 0});
        world.Join(JointOf<HingeJointSettings>(hook, disc, {x, 0, 0}, {0, 0, 1}));
        return disc;
    };
    const BodyId small = addDisc(-0.1, 0.1, 0), big = addDisc(0.4, 0.4, 3);
    GearJointSettings gear = JointOf<GearJointSettings>(small, big, {-0.1, 0, 0}, {0, 0, 1});
    gear.anchorB = JointAnchor{.point = {0.4, 0, 0}, .axis = {0, 0, 1}};
    gear.ratio = 4;
    world.Join(gear);
    double ofSmall = 0, ofBig = 0, drift = 0;
    const auto facing = [&](BodyId id) {
        const Vector3 x = Rotate(world.Bodies().GetPose(id).rotation, Vector3(1, 0, 0));
        return std::atan2(double(x.y()), double(x.x()));
    };
    double lastSmall = facing(small), lastBig = facing(big);
    for (int i = run.Steps(5); i > 0; --i) {
        world.Step();
        const double nowSmall = facing(small), nowBig = facing(big);
        ofSmall += std::remainder(nowSmall - lastSmall, 2 * kPi);
        ofBig += std::remainder(nowBig - lastBig, 2 * kPi);
        lastSmall = nowSmall;
        lastBig = nowBig;
        drift = std::max(drift, std::abs(ofSmall + 4 * ofBig));
    }
    const double reference = 3 * 256.0 / (256 + 16);
    run.Error("speed", Relative(world.Turn(big).z(), reference));
    run.Error("ratio", Relative(-world.Turn(small).z(), 4 * reference));
    run.Error("drift_rad", drift);
    run.Observe(ofBig / (5 * reference));
}

// A rope with l1 + 4 l2 constant, equal masses: m a1 = T - m g, m a2 = 4 T - m g, a1 + 4 a2 = 0, so that a1 = -12 g /
// 17 and a2 = 3 g / 17.
void Pulley(LabRun& run) {
    LabWorld world(run);
    const ShapePtr shape = BoxOf(0.25, 0.25, 0.25);
    const BodyId a = world.Add({.shape = shape, .position = {-5, 0, 0}, .mass = 10});
    const BodyId b = world.Add({.shape = shape, .position = {5, 0, 0}, .mass = 10});
    PulleyJointSettings rope = JointOf<PulleyJointSettings>(a, b, {-5, 0, 0});
    rope.anchorB = JointAnchor{.point = {5, 0, 0}};
    rope.fixedPointA = {-5, 10, 0};
    rope.fixedPointB = {5, 10, 0};
    rope.ratio = 4;
    world.Join(rope);
    const double length = 10 + 4 * 10;
    world.Steps(1);
    const double t = world.Time();
    const double ofA = -12.0 / 17 * kGravity * t * t / 2, ofB = 3.0 / 17 * kGravity * t * t / 2;
    run.Error("way", std::max(Relative(world.At(a).y(), ofA), Relative(world.At(b).y(), ofB)));
    run.Error("length", std::abs(10 - world.At(a).y() + 4 * (10 - world.At(b).y()) - length) / length);
    run.Observe(world.At(a).y() / ofA);
}

// A ball hits the last of eight jointed links from the side: momentum and angular momentum about the chain's middle
// stay, and there is no gravity.
void Momentum(LabRun& run) {
    constexpr int kLinks = 8;
    LabWorld world(run, kNoGravity);
    const ShapePtr link = BoxOf(0.2, 0.1, 0.1);
    std::vector<BodyId> bodies;
    for (int i = 0; i < kLinks; ++i) {
        const double x = 0.5 * (i - 0.5 * (kLinks - 1));
        bodies.push_back(world.Add({.shape = link, .position = {x, 0, 0}, .mass = 1}));
        if (i > 0) world.Join(JointOf<PointJointSettings>(bodies[i - 1], bodies[i], {x - 0.25, 0, 0}));
    }
    bodies.push_back(
        world.Add({.shape = SphereOf(0.3), .position = {1.7, 0.05, -3}, .linearVelocity = {0, 0, 5}, .mass = 10}));
    const auto momenta = [&] {
        Position linear = Position::Zero(), angular = Position::Zero();
        for (const BodyId id : bodies) {
            const Position p = world.Speed(id) * double(world.Bodies().GetMass(id));
            linear += p;
            angular += world.At(id).cross(p) + world.Bodies().GetAngularMomentum(id).cast<double>();
        }
        return std::pair(linear, angular);
    };
    const auto [linear, angular] = momenta();
    double ofLinear = 0, ofAngular = 0;
    for (int i = run.Steps(4); i > 0; --i) {
        world.Step();
        const auto [l, a] = momenta();
        ofLinear = std::max(ofLinear, (l - linear).norm() / linear.norm());
        ofAngular = std::max(ofAngular, (a - angular).norm() / angular.norm());
    }
    run.Error("angular_momentum", ofAngular);
    run.Error("momentum", ofLinear);
    run.Error("gaps", world.SumOfGaps() / 4);
    for (int i = 0; i < 3; ++i) run.Observe(world.Speed(bodies.back())[i] / 5);
}

LabScene Pulled(const char* variant, double way, double bound) {
    return {.name = "spring",
            .variant = variant,
            .what = "a body on a spring of 2 Hz and damping ratio 0.1, pulled out by 1 m (near), 10 m (far), 3 s",
            .error = "largest distance from the closed form, over the first one",
            .parameter = way,
            .influences = kJoints,
            .testBound = bound,
            .run = Spring};
}

}  // namespace

std::vector<LabScene> DriveScenes() {
    return {
        Pulled("near", 1, 0.05),
        // Joints are pulled at 20 m/s at most (SystemSettings::jointPushSpeed), springs of users, too: this one wants
        // 125.
        Pulled("far", 10, 2),
        {.name = "motor",
         .variant = "drive",
         .what = "a slider of 8000 kg driven to 3 m/s by at most 16000 N",
         .error = "speed after 1 s and 2 s, over 3 m/s",
         .influences = kJoints,
         .testBound = 1e-3,
         .run = Motor},
        {.name = "motor",
         .variant = "friction",
         .what = "a slider of 8000 kg braked by 16000 N from 10 m/s",
         .error = "speed after 2 s, over 10 m/s",
         .influences = kJoints,
         .testBound = 1e-3,
         .run = Brake},
        {.name = "gear_pulley",
         .variant = "gears",
         .what = "gears of 100 and 400 teeth, the big one turning at 3 rad/s when they mesh, 5 s",
         .error = "speed of the big one, relative (2.8235 rad/s)",
         .influences = kJoints,
         .testBound = 0.01,
         .run = Gears},
        {.name = "gear_pulley",
         .variant = "pulley",
         .what = "equal masses on a pulley of ratio 4, 1 s",
         .error = "ways, relative (-6.925 and 1.731 m/s2)",
         .influences = kJoints,
         .testBound = 0.01,
         .run = Pulley},
        {.name = "momentum",
         .what = "a ball of 10 kg at 5 m/s into a chain of 8 links, no gravity, 4 s",
         .error = "drift of the angular momentum, relative",
         .influences = {.contacts = true, .joints = true},
         .testBound = 0.05,
         .run = Momentum},
    };
}

}  // namespace fulcrum::accuracy
