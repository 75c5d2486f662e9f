#include <Fulcrum/UnitTests/Random/Mechanism.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum::testing {

namespace {

// The larger of the two; infinity for what is not a number.
double Larger(double a, double b) {
    return std::isfinite(b) ? std::max(a, b) : std::numeric_limits<double>::infinity();
}

template <class Measure>
double Largest(PhysicsSystem& world, const BatchIds& ids, const Trial& trial, Measure&& measure) {
    double largest = 0;
    const int steps = static_cast<int>(std::lround(trial.seconds / trial.dt));
    for (int i = 1; i <= steps; ++i) {
        static_cast<void>(world.Update(trial.dt).Value());
        largest = Larger(largest, measure());
        if (trial.watch) trial.watch(world, ids, i * trial.dt);
    }
    return largest;
}

SystemSettings Sleepless(const Trial& trial) {
    SystemSettings settings = trial.settings;
    settings.sleep.enabled = false;
    return settings;
}

}  // namespace

std::unique_ptr<PhysicsSystem> WorldOf(const Mechanism& mechanism, const SystemSettings& settings, BatchIds& ids) {
    std::unique_ptr<PhysicsSystem> world = PhysicsSystem::Create(settings).Value();
    ids = world->Bodies().Commit(BodyBatch::Prepare(mechanism.bodies, mechanism.joints).Value()).Value();
    return world;
}

bool IsAnchored(const Mechanism& mechanism) {
    return std::ranges::any_of(mechanism.joints, [](const BodyBatch::Joint& joint) {
        return std::visit(
            [](const auto& settings) {
                if constexpr (requires { settings.bodyA; })
                    return settings.bodyA == kWorldBody || settings.bodyB == kWorldBody;
                else return false;
            },
            joint);
    });
}

Masses MassesOf(const PhysicsSystem& world, const BatchIds& ids) {
    Masses masses;
    for (const BodyId id : ids.bodies) {
        const double mass = static_cast<double>(world.Bodies().GetMass(id));
        masses.sum += mass;
        masses.largest = std::max(masses.largest, mass);
    }
    return masses;
}

double KineticEnergyAtRest(const Mechanism& mechanism, const Trial& trial) {
    SystemSettings settings = Sleepless(trial);
    settings.gravity = Vector3::Zero();
    BatchIds ids;
    const std::unique_ptr<PhysicsSystem> world = WorldOf(mechanism, settings, ids);
    const double largest = Largest(*world, ids, trial, [&] {
        double energy = 0;
        for (const BodyId id : ids.bodies) energy += world->Bodies().GetKineticEnergy(id);
        return energy;
    });
    return largest / MassesOf(*world, ids).largest;
}

double HeightGained(const Mechanism& mechanism, const Trial& trial) {
    const SystemSettings settings = Sleepless(trial);
    BatchIds ids;
    const std::unique_ptr<PhysicsSystem> world = WorldOf(mechanism, settings, ids);
    const double start = world->GetEnergy();
    const double gain = Largest(*world, ids, trial, [&] { return world->GetEnergy() - start; });
    return gain / (MassesOf(*world, ids).sum * static_cast<double>(Length(settings.gravity)));
}

}  // namespace fulcrum::testing
