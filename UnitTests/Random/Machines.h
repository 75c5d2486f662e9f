// Random machines of rods: pinned together at their ends by ball joints and hinges, some of them driven, limited or
// with friction, in open chains and closed loops, with a weight. All joints are satisfied exactly and all motors are at
// their place, so that without gravity nothing moves. Bodies collide with nothing.
#pragma once

#include <Fulcrum/UnitTests/Random/Mechanism.h>

namespace fulcrum::testing {

enum class MachineKind : uint8_t {
    Plane,  // all in the plane z = 0, hinges along z
    Space,  // hinges along z or in all directions
};

// Of 2 to 7 rods, free or pinned to the world at one or two places.
Mechanism RandomMachine(MachineKind kind, uint64_t seed);

}  // namespace fulcrum::testing
