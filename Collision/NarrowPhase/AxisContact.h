// Manifolds from a known axis of separation or least penetration: a face contact if a face normal is nearly as good an
// axis, otherwise one of the supporting edges or vertices. Called by CollidePolyhedra and the libccd pair function.
// Thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

namespace fulcrum {

struct KnownAxis {
    Vector3 axis;      // unit, from A towards B
    float separation;  // m, of the cores along it
    float tolerance;   // m: error of the axis; vertices this close to the extreme one belong to the supporting feature
};

// Writes the manifold and the cache. Of equally good faces the cached kind is preferred.
void BuildContactFromAxis(const PolyhedronPair& pair, const KnownAxis& known, const ContactTolerances& tolerances,
                          PairCache& cache, Manifold& manifold);

// The pair of edges that touched in the last step, if they are proven to be the closest features still; writes the
// manifold. `beyondReach`: the axis of the edges separates the pair, no points.
struct EdgeContact {
    bool proven = false;
    bool beyondReach = false;
};
EdgeContact TryCachedEdges(const PolyhedronPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                           Manifold& manifold);

}  // namespace fulcrum
