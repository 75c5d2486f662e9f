// Distance of the cores of any two convex shapes through their support functions alone, curved cores included. Called
// by CollideConvex and the queries. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/Collision/NarrowPhase/SupportPair.h>

namespace fulcrum {

struct ConvexGjkResult {
    using Status = GjkStatus;
    Status status;
    Vector3 axis;                    // unit, from A towards B; if overlapping, the last one tried
    float separation;                // m of the cores along the axis: a lower bound of their distance if beyond reach
    Vector3 onA, onB;                // the cores' closest points in A's frame, m; if apart
    Simplex<SupportVertex> simplex;  // if overlapping: 1 to 4 vertices around or at the origin
};

// `start`: a unit vector, the guess of the axis (A's frame). Ends as soon as the cores are found to be farther apart
// than `reach`. The distance is exact to about 1e-6 of the shapes' size; the whole shapes are RadiusSum() closer. Cores
// less than about 1e-6 of their size apart count as overlapping.
ConvexGjkResult ConvexGjk(const SupportPair& pair, const Vector3& start, float reach);

// The weights of the corners of a simplex of 1 to 3, as GJK leaves it, in its point closest to the origin.
Position ClosestWeights(const Simplex<SupportVertex>& simplex);

}  // namespace fulcrum
