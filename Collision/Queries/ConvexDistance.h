// Signed distance of two convex shapes, by their support functions. Called by the queries. Thread-safe; allocates
// nothing unless EPA fails and libccd is used, or with the method Libccd.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>

namespace fulcrum {

struct ConvexSeparation {
    bool isBeyond = false;             // farther apart than `reach`: nothing else is set
    float separation = 0;              // m, of the rounded shapes; negative: minus the penetration depth
    Vector3 normal = Vector3::Zero();  // unit, from A towards B, A's frame
    Vector3 onA = Vector3::Zero();     // m, A's frame: the surface's closest, or deepest, points
    Vector3 onB = Vector3::Zero();
};

// Exact to about 1e-6 of the shapes' size if apart, 3e-5 if overlapping. `reach`: m; if negative, overlaps of less than
// that may be measured as deeper than they are, but not as deep.
ConvexSeparation MeasureConvex(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, float reach,
                               NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

// Whether they have a point in common; touching counts.
bool OverlapConvex(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA,
                   NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

}  // namespace fulcrum
