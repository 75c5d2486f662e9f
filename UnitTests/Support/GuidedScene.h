// Bodies with locked axes, in all combinations, fall on each other, and some are joined: the scene for comparing
// builds, threads and versions of locked translations.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

// Hash of the whole state after 90 steps with so many threads. Adds a failure where a body has left its line or plane.
uint64_t HashOfGuidedScene(uint32_t threads);

// m/s: the fastest of the bodies in 240 steps of such a scene, made from the seed.
float FastestOfGuidedScene(uint32_t seed);

// The most that its kinetic and potential energy rise above their least so far in 240 steps, as a fraction of what
// there is in the beginning, zero being the floor: without the kinematic plate that turns below the bodies, which
// wedges those that locked axes hold in its way, and throws them.
double EnergyRiseOfGuidedScene(uint32_t seed);

}  // namespace fulcrum::testing
