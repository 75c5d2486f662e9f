// Distance between two polyhedra by the algorithm of Gilbert, Johnson and Keerthi (IEEE J. Robotics and Automation 4(2),
// 1988), started from a known axis. Called by CollidePolyhedra. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/PolyhedronPair.h>

namespace fulcrum {

struct Simplex {
    MinkowskiVertex vertices[4];
    int count = 0;
};

struct GjkResult {
    enum class Status { BeyondReach, Apart, Overlapping };
    Status status;
    Vector3 axis;      // unit, from A towards B; the separating axis, or that of the closest points
    float separation;  // m along the axis: a lower bound of the distance where beyond reach, else the distance
    Simplex simplex;   // where overlapping: 1 to 4 vertices around or at the origin
};

// `start`: a unit vector, the guess of the axis. Ends as soon as the cores are found to be farther apart than `reach`.
GjkResult Gjk(const PolyhedronPair& pair, const Vector3& start, float reach);

}  // namespace fulcrum
