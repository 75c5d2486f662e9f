// Newton's law of restitution. Impacts bounce down to 1 cm/s here (SystemSettings::restitutionSpeed): the default of
// 0.5 m/s ends the bounces early, as users want it.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

void BouncesAll(SystemSettings& settings) { settings.restitutionSpeed = 0.01f; }

// When a ball dropped from `height` with restitution e last comes down through `low` m: n bounces take it to e^2n h.
double SettlingTime(double e, double height, double low) {
    double time = std::sqrt(2 * height / kGravity), last = std::sqrt(2 * (height - low) / kGravity);
    for (double apex = e * e * height; apex > low; apex *= e * e) {
        const double flight = 2 * std::sqrt(2 * apex / kGravity);
        last = time + flight / 2 + std::sqrt(2 * (apex - low) / kGravity);
        time += flight;
    }
    return last;
}

// Dropped from 2 m: rises to e^2 h, with e = 1 never above 2 m; comes to rest after sqrt(2 h / g) (1 + e) / (1 - e),
// measured at the last time that it is 5 mm above the ground.
void Restitution(LabRun& run) {
    constexpr double kHeight = 2, kRadius = 0.2, kLow = 0.005;
    const double e = run.parameter;
    LabWorld world(run, kDown, BouncesAll);
    world.AddFloor(0.5f, static_cast<float>(e));
    const BodyId ball = world.Add({.shape = SphereOf(kRadius),
                                   .position = {0, kHeight + kRadius, 0},
                                   .material = {.restitution = static_cast<float>(e)}});
    const double settling = SettlingTime(std::min(e, 0.95), kHeight, kLow);
    const double firstImpact = std::sqrt(2 * kHeight / kGravity);
    double rebound = 0, highest = 0, previous = kHeight;
    bool hasRisen = false;
    Crossings low;
    for (int i = run.Steps(1.1 * settling + 0.5); i > 0; --i) {
        world.Step();
        const double height = world.At(ball).y() - kRadius;
        low.Sample(world.Time(), height - kLow);
        // The apex lies between samples: from the energy of the flight where there is one.
        const double speed = world.Speed(ball).y();
        const double apex = height + speed * speed / (2 * kGravity);
        hasRisen |= speed > 0;
        if (hasRisen && rebound == 0 && speed <= 0 && height > kLow) rebound = apex;
        if (world.Time() > firstImpact) highest = std::max(highest, height);
        previous = height;
    }
    run.Error("rebound", std::abs(rebound - e * e * kHeight) / kHeight);
    if (e == 1) run.Error("rise", std::max(0.0, highest - kHeight) / kHeight);
    if (e > 0 && e < 1) run.Error("time", low.Times().empty() ? 1 : Relative(low.Times().back(), settling));
    run.Require(highest <= kHeight * 1.01, "energy at most 1.01 of the start");
    run.Observe(rebound / kHeight);
    run.Observe(previous / kHeight);
}

// 49 elastic balls without friction: their energy, 49 m g h = 24034.5 J from where they would rest, stays.
void BouncingField(LabRun& run) {
    constexpr double kMass = 10, kRadius = 0.1, kHeight = 5;
    LabWorld world(run, kDown, BouncesAll);
    world.AddFloor(0, 1);
    const ShapePtr shape = SphereOf(kRadius);
    for (int x = -3; x <= 3; ++x)
        for (int z = -3; z <= 3; ++z)
            world.Add({.shape = shape,
                       .position = {1.0 * x, kHeight + kRadius, 1.0 * z},
                       .mass = kMass,
                       .material = {.friction = 0, .restitution = 1}});
    const double rest = 49 * kMass * kGravity * kRadius, reference = 49 * kMass * kGravity * kHeight;
    double squares = 0, most = 0, energy = 0;
    const int steps = run.Steps(20);
    for (int i = 0; i < steps; ++i) {
        world.Step();
        energy = world.Energy() - rest;
        squares += (energy / reference - 1) * (energy / reference - 1);
        most = std::max(most, energy / reference);
    }
    run.Error("energy", std::sqrt(squares / steps));
    run.Require(most <= 1.01, "energy at most 1.01 of the start");
    run.Observe(energy / reference);
}

LabScene Drop(const char* variant, double e) {
    return {.name = "restitution",
            .variant = variant,
            .what = "a ball of 0.2 m dropped from 2 m, restitution in the name",
            .error = "height of the first rebound from e^2 h, over h",
            .parameter = e,
            .influences = {.contacts = true},
            .testBound = 0.01,
            .run = Restitution};
}

}  // namespace

std::vector<LabScene> BouncingScenes() {
    return {
        Drop("0", 0),
        Drop("0.3", 0.3),
        Drop("0.5", 0.5),
        Drop("0.8", 0.8),
        Drop("0.95", 0.95),
        Drop("1", 1),
        {.name = "bouncing_field",
         .what = "7 x 7 elastic balls of 10 kg, 5 m up, without friction, 20 s",
         .error = "RMS of the energy's error, relative",
         .influences = {.contacts = true},
         .testBound = 0.01,
         .run = BouncingField},
    };
}

}  // namespace fulcrum::accuracy
