// Manifolds from a known axis of separation or least depth: faces where one is nearly as good an axis, else the edges
// or vertices that lie farthest along it. Called by CollidePolyhedra and the libccd pair function. Thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

namespace fulcrum {

struct KnownAxis {
    Vector3 axis;      // unit, from A towards B
    float separation;  // m, of the cores along it
    float tolerance;   // m: by which a vertex may miss the supporting feature because the axis is not exact
};

// Writes the manifold and what to remember. A face of the cached kind is preferred among equals.
void BuildContactFromAxis(const PolyhedronPair& pair, const KnownAxis& known, const ContactTolerances& tolerances,
                          PairCache& cache, Manifold& manifold);

// The pair of edges that touched in the last step, if they still are the closest features beyond doubt; writes the
// manifold. `beyondReach`: the axis of the edges separates the pair, no points.
struct EdgeContact {
    bool proven = false;
    bool beyondReach = false;
};
EdgeContact TryCachedEdges(const PolyhedronPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                           Manifold& manifold);

}  // namespace fulcrum
