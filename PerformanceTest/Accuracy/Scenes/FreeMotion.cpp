// Bodies without contacts and joints: flight and free rotation. Only the time step matters.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>
#include <array>

namespace fulcrum::accuracy {
namespace {

// x = v0 t + g t^2 / 2, after 10 s. Symplectic Euler is off by g t dt / 2.
void Projectile(LabRun& run) {
    LabWorld world(run);
    const Position v0(-2, 2, 8);
    const BodyId ball = world.Add({.shape = SphereOf(0.5), .linearVelocity = v0.cast<float>()});
    world.Steps(10);
    const double t = world.Time();
    const Position reference = v0 * t + Position(0, -0.5 * kGravity * t * t, 0);
    const Position way = world.At(ball);
    run.Error("position", (way - reference).norm() / reference.norm());
    run.Figure("meters", (way - reference).norm());
    for (int i = 0; i < 3; ++i) run.Observe(way[i] / reference.norm());
}

// A box of 10 kg whose middle axis is y: principal inertia m (b^2 + c^2) / 12.
struct SpinningBox {
    static constexpr double kMass = 10;
    static constexpr std::array<double, 3> kSize = {0.1, 0.4, 0.9};  // m

    static double Inertia(int axis) {
        const double a = kSize[(axis + 1) % 3], b = kSize[(axis + 2) % 3];
        return kMass / 12 * (a * a + b * b);
    }
    static BodyId AddTo(LabWorld& world, const Position& spin) {
        return world.Add({.shape = BoxOf(kSize[0] / 2, kSize[1] / 2, kSize[2] / 2),
                          .angularVelocity = spin.cast<float>(),
                          .mass = static_cast<float>(kMass)});
    }
};

// Euler's equations I w' = (I w) x w in body axes, by the classical Runge-Kutta method with steps of 0.1 ms: the times
// at which w_y changes its sign, exact to 1e-9 s.
const std::vector<double>& FlipTimes() {
    static const std::vector<double> times = [] {
        const Position inertia(SpinningBox::Inertia(0), SpinningBox::Inertia(1), SpinningBox::Inertia(2));
        const auto rate = [&](const Position& w) { return inertia.cwiseProduct(w).cross(w).cwiseQuotient(inertia); };
        constexpr double kDt = 1e-4;
        Crossings crossings;
        Position w(0.1, 5, 0.1);
        for (int i = 0; i <= 100'000; ++i) {
            crossings.Sample(i * kDt, w.y());
            const Position a = rate(w), b = rate(w + a * (kDt / 2)), c = rate(w + b * (kDt / 2)), d = rate(w + c * kDt);
            w += (a + 2.0 * b + 2.0 * c + d) * (kDt / 6);
        }
        return crossings.Times();
    }();
    return times;
}

// Energy and angular momentum stay; the middle axis is unstable, so that the body turns over and over.
void FreeRotation(LabRun& run) {
    LabWorld world(run, kNoGravity);
    const BodyId box = SpinningBox::AddTo(world, {0.1, 5, 0.1});
    const double energy = world.Bodies().GetKineticEnergy(box);
    const Position momentum = world.Bodies().GetAngularMomentum(box).cast<double>();
    double energyDrift = 0, momentumDrift = 0;
    Crossings flips;
    flips.Sample(0, 5);
    for (int i = run.Steps(10); i > 0; --i) {
        world.Step();
        energyDrift = std::max(energyDrift, Relative(world.Bodies().GetKineticEnergy(box), energy));
        const Position now = world.Bodies().GetAngularMomentum(box).cast<double>();
        momentumDrift = std::max(momentumDrift, (now - momentum).norm() / momentum.norm());
        const Vector3 inBody =
            InverseRotate(world.Bodies().GetPose(box).rotation, world.Bodies().GetAngularVelocity(box));
        flips.Sample(world.Time(), inBody.y());
    }
    const std::vector<double>& reference = FlipTimes();
    const bool hasThird = flips.Times().size() >= 3;
    run.Error("third_flip", hasThird ? Relative(flips.Times()[2], reference[2]) : 1);
    run.Error("energy", energyDrift);
    run.Error("angular_momentum", momentumDrift);
    run.Observe(hasThird ? flips.Times()[2] / reference[2] : 0);
}

// About the middle axis, at a speed that a step cannot follow: the energy may not rise.
void FastSpin(LabRun& run) {
    LabWorld world(run, kNoGravity);
    const double spin = run.parameter;
    const BodyId box = SpinningBox::AddTo(world, {0.02 * spin, spin, 0.02 * spin});
    const double start = world.Bodies().GetKineticEnergy(box);
    double most = start, clamped = 0;
    for (int i = run.Steps(run.Seconds(100, 10)); i > 0; --i) {
        world.Step();
        most = std::max(most, world.Bodies().GetKineticEnergy(box));
        if (!world.IsPeer()) clamped += world.Ours("").Report().clampedBodies;
    }
    run.Error("energy_rise", most / start - 1);
    run.Figure("steps_held_to_largest_speed", clamped);
    run.Require(most <= 1.01 * start, "energy at most 1.01 of the start");
    run.Observe(world.Bodies().GetKineticEnergy(box) / start);
}

LabScene Spin(const char* variant, double spin) {
    return {.name = "fast_spin",
            .variant = variant,
            .what = "a box 0.1 x 0.4 x 0.9 m that turns about its middle axis, rad/s in the name",
            .error = "largest kinetic energy over that at the start, less 1",
            .parameter = spin,
            .isExtreme = true,
            .testBound = 0.01,
            .run = FastSpin};
}

}  // namespace

std::vector<LabScene> FreeMotionScenes() {
    return {
        {.name = "projectile",
         .what = "a ball thrown at (-2, 2, 8) m/s, 10 s of flight",
         .error = "distance from the parabola's end over its chord of 478 m",
         .testBound = 1e-5,  // velocities are floats: 2400 steps, each off by up to 4e-6 of 98 m/s at random
         .run = Projectile},
        {.name = "free_rotation",
         .what = "a box 0.1 x 0.4 x 0.9 m of 10 kg turning at (0.1, 5, 0.1) rad/s, no gravity, 10 s",
         .error = "time of the third flip about the middle axis, relative",
         .testBound = 1e-3,
         .run = FreeRotation},
        Spin("20", 20),
        Spin("100", 100),
        Spin("1000", 1000),
    };
}

}  // namespace fulcrum::accuracy
