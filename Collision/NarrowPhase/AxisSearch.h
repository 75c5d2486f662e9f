// The full separating axis test of two overlapping polyhedra: every face normal and every pair of edges that forms a
// face of their Minkowski difference. Robust and slow: called if EPA fails. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/PolyhedronPair.h>

namespace fulcrum {

struct FoundAxis {
    Vector3 axis;      // unit, from A towards B
    float separation;  // m of the cores along it
};

// At least one of the two has faces.
FoundAxis SearchAllAxes(const PolyhedronPair& pair);

}  // namespace fulcrum
