// Depth of two overlapping polyhedra by expanding a polytope inside their Minkowski difference towards its boundary
// (G. van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects, GDC 2001).
// Called by CollidePolyhedra. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Gjk.h>

namespace fulcrum {

struct EpaResult {
    bool found;        // false: degenerate input, or more faces than the polytope holds
    Vector3 axis;      // unit, from A towards B
    float separation;  // m along the axis, <= 0
};

// `simplex`: what GJK ended with. The result is the axis of least depth to within about 1e-6 of the shapes' size.
EpaResult Epa(const PolyhedronPair& pair, const Simplex& simplex);

}  // namespace fulcrum
