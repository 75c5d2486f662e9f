// Bodies and joints as data, and what they do when they are left alone: how fast they move at rest without gravity, how
// high they rise by themselves with it. For the random mechanisms of this folder, and for programs that measure and
// shorten them, so without a test library. One thread per call.
#pragma once

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Samples/Scenes/Random.h>
#include <Fulcrum/UnitTests/Support/JointOf.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <functional>
#include <memory>
#include <vector>

namespace fulcrum::testing {

struct Mechanism {
    std::vector<BodySettings> bodies;
    std::vector<BodyBatch::Joint> joints;  // of bodies BodyBatch::Body(index) and kWorldBody
};

// How a mechanism is stepped. Nothing sleeps.
struct Trial {
    double dt = 1.0 / 60, seconds = 10;  // s
    SystemSettings settings{};
    // Called after each step, if set.
    std::function<void(PhysicsSystem&, const BatchIds&, double time)> watch{};
};

// A world of a mechanism and of nothing else. Aborts where the engine refuses it.
std::unique_ptr<PhysicsSystem> WorldOf(const Mechanism& mechanism, const SystemSettings& settings, BatchIds& ids);

// Whether a joint attaches it to the world.
bool IsAnchored(const Mechanism& mechanism);

// J/kg: the largest kinetic energy without gravity, of all bodies, by the mass of the heaviest. Exactly solved it is 0
// if all joints are satisfied at the start and nothing drives them. Infinite if a number is not finite.
double KineticEnergyAtRest(const Mechanism& mechanism, const Trial& trial);

// m: the largest gain of energy over the start, by the weight of all bodies. Exactly solved it is not above 0 if no
// spring is strained at the start. Infinite likewise.
double HeightGained(const Mechanism& mechanism, const Trial& trial);

// kg, of the bodies of a world that have any.
struct Masses {
    double sum = 0, largest = 0;
};
Masses MassesOf(const PhysicsSystem& world, const BatchIds& ids);

// Random numbers of the generators: any seed of 64 bits, neighbors as unlike as others.
inline RandomPoses RandomOf(uint64_t seed) { return RandomPoses(static_cast<uint32_t>(Random(seed).Next())); }

// Uniform in its logarithm.
inline float LogBetween(RandomPoses& random, double low, double high) {
    const float x = random.Between(static_cast<float>(Log(low)), static_cast<float>(Log(high)));
    return static_cast<float>(Exp(static_cast<double>(x)));
}

}  // namespace fulcrum::testing
