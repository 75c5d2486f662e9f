// The narrow phase: contact manifolds of pairs of convex shapes. Called by the Collide stage, from many threads at
// once.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Which function is used for a pair. Automatic: the fastest exact one of the pair table. Libccd: GJK/EPA for every
// pair.
enum class NarrowPhaseMethod : uint8_t { Automatic, Libccd };

struct CollideSettings {
    float speculativeDistance = 0.02f;  // m, > 0: shapes this far apart already get points
    NarrowPhaseMethod method = NarrowPhaseMethod::Automatic;
};

// Counts of what went wrong inside libccd; each worker has its own, the step's report adds them up.
struct CollideCounters {
    uint32_t epaFailures = 0;          // EPA gave up and MPR answered
    uint32_t centerLineFallbacks = 0;  // MPR failed too: normal along the center line
};

// Writes the manifold of a and b, `bInA` being the pose of b's center frame in a's. At most 4 points, chosen for area
// and depth, no point with a separation above settings.speculativeDistance. Never fails: the worst case is a
// center-line normal, counted. Allocates nothing where a special function serves the pair. Thread-safe.
void Collide(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters);

}  // namespace fulcrum
