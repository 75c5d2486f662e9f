// Random bodies of any mass, connected by joints of every kind at random points. All joints are satisfied, all motors
// and springs are at their place and all limits apart, so that without gravity nothing moves. Bodies collide with
// nothing.
#pragma once

#include <Fulcrum/UnitTests/Random/Mechanism.h>

namespace fulcrum::testing {

enum class StructureKind : uint8_t {
    Tree,   // no loops but through the world
    Graph,  // further joints close loops
};

// Of 2 to 8 bodies, free or attached to the world at one or two places. Gears, racks and pulleys, which need the world,
// are in graphs that are attached.
Mechanism RandomStructure(StructureKind kind, uint64_t seed);

}  // namespace fulcrum::testing
