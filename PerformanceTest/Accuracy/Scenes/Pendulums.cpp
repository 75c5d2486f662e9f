// Pendulums released at the height of their pivot: amplitude 90 degrees, T = 4 sqrt(I / (m g l)) K(sin 45 degrees).
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>
#include <Fulcrum/UnitTests/Support/EllipticIntegral.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

// The swing of a body about the origin in the x-y plane, its center `arm` m from it.
struct Swing {
    double period = 0, gap = 0, energyDrift = 0;  // s, m, of m g arm
    Position end = Position::Zero();
};

// `gap` measures how far the joint is open.
Swing Watch(LabRun& run, LabWorld& world, BodyId body, double arm, FunctionRef<double()> gap) {
    const double start = world.Energy(), scale = world.Bodies().GetMass(body) * kGravity * arm;
    Swing swing;
    Crossings crossings;
    for (int i = run.Steps(10); i > 0; --i) {
        world.Step();
        swing.end = world.At(body);
        crossings.Sample(world.Time(), swing.end.x());
        swing.gap = std::max(swing.gap, gap());
        swing.energyDrift = std::max(swing.energyDrift, std::abs(world.Energy() - start) / scale);
    }
    swing.period = crossings.Period().value_or(0);
    return swing;
}

void Report(LabRun& run, const Swing& swing, double period, double arm) {
    run.Error("period", Relative(swing.period, period));
    run.Error("energy", swing.energyDrift);
    run.Error("gap", swing.gap);
    run.Observe(swing.end.x() / arm);
    run.Observe(swing.end.y() / arm);
}

// A rod of 1 x 0.1 x 0.1 m hinged at the center of its end face: I = m (1 + 0.01) / 12 + m / 4, l = 0.5 m.
void RodPendulum(LabRun& run) {
    LabWorld world(run);
    const BodyId rod = world.Add({.shape = BoxOf(0.5, 0.05, 0.05), .position = {0.5, 0, 0}, .mass = 1});
    const JointId hinge = world.Join(JointOf<HingeJointSettings>(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}));
    const Swing swing = Watch(run, world, rod, 0.5, [&] { return double(world.Joints().GetError(hinge).distance); });
    const double inertia = 1.01 / 12 + 0.25;
    Report(run, swing, 4 * std::sqrt(inertia / (kGravity * 0.5)) * testing::EllipticK(std::sin(kPi / 4)), 0.5);
}

// A point on a rod of 1 m: I = m l^2. Integrates phi'' = -g sin(phi) by the classical Runge-Kutta method with steps of
// 0.1 ms for the place after 10 s.
Position EndOfPointPendulum() {
    constexpr double kDt = 1e-4;
    double angle = -kPi / 2, speed = 0;
    const auto pull = [](double phi) { return -kGravity * std::sin(phi); };
    for (int i = 0; i < 100'000; ++i) {
        const double a1 = speed, b1 = pull(angle), a2 = speed + b1 * kDt / 2, b2 = pull(angle + a1 * kDt / 2),
                     a3 = speed + b2 * kDt / 2, b3 = pull(angle + a2 * kDt / 2), a4 = speed + b3 * kDt,
                     b4 = pull(angle + a3 * kDt);
        angle += (a1 + 2 * a2 + 2 * a3 + a4) * kDt / 6;
        speed += (b1 + 2 * b2 + 2 * b3 + b4) * kDt / 6;
    }
    return {std::sin(angle), -std::cos(angle), 0};
}

void PointPendulum(LabRun& run) {
    LabWorld world(run);
    const BodyId ball = world.Add({.shape = SphereOf(0.001), .position = {-1, 0, 0}, .mass = 1});
    world.Join(JointOfTwo<DistanceJointSettings>(AddHook(world), ball, {0, 0, 0}, {-1, 0, 0}));
    const Swing swing = Watch(run, world, ball, 1, [&] { return std::abs(world.At(ball).norm() - 1); });
    Report(run, swing, 4 / std::sqrt(kGravity) * testing::EllipticK(std::sin(kPi / 4)), 1);
    static const Position end = EndOfPointPendulum();
    run.Error("position", (swing.end - end).norm());
}

}  // namespace

std::vector<LabScene> PendulumScenes() {
    return {
        {.name = "pendulum",
         .what = "a rod of 1 m hinged at its end face, released horizontal, 10 s",
         .error = "period, relative (1.93575 s)",
         .influences = {.joints = true},
         .testBound = 1e-4,
         .run = RodPendulum},
        {.name = "point_pendulum",
         .what = "a ball of 1 mm on a rod of 1 m (distance joint), released horizontal, 10 s",
         .error = "period, relative (2.367842 s)",
         .influences = {.joints = true},
         .testBound = 1e-3,
         .run = PointPendulum},
    };
}

}  // namespace fulcrum::accuracy
