// The narrow phase: contact manifolds of pairs of convex shapes. Called by the Collide stage, from many threads at
// once.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// How pairs of shapes are collided. Automatic: by the fastest exact function of the pair table. Libccd: by libccd's GJK
// and EPA wherever two shapes meet, for comparison; slower by far, and it allocates. See Docs/Architecture.md.
enum class NarrowPhaseMethod : uint8_t { Automatic, Libccd };

struct CollideSettings {
    float speculativeDistance = 0.02f;  // m, > 0: shapes this far apart already get points
    NarrowPhaseMethod method = NarrowPhaseMethod::Automatic;
};

// Counts of what went wrong inside libccd; each worker has its own, the step's report adds them up.
struct CollideCounters {
    // EPA contradicted itself from every start: the best is taken of what it and MPR found, the center line and the
    // shapes' axes, all polished.
    uint32_t epaFailures = 0;
    uint32_t centerLineFallbacks = 0;  // MPR failed, too

    CollideCounters& operator+=(const CollideCounters& other) {
        epaFailures += other.epaFailures;
        centerLineFallbacks += other.centerLineFallbacks;
        return *this;
    }
};

class Plane;

// Writes the manifold of a and b, `bInA` being the pose of b's center frame in a's. At most 4 points, chosen for area
// and depth, no point with a separation above settings.speculativeDistance. Never fails: the worst case is a
// center-line normal, counted. Allocates nothing unless by libccd. Thread-safe.
void Collide(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters);
// The same where b is a half space.
void Collide(const ConvexShape& a, const Plane& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters);

}  // namespace fulcrum
