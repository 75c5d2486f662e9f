// The axis of least depth of two overlapping polyhedra by trying every face normal and every pair of edges that meet in
// their Minkowski difference. Exact whatever the input and slow: called by CollidePolyhedra where EPA gives up.
// Allocates nothing; thread-safe.
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
