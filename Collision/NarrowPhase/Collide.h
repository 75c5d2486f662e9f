// The narrow phase: contact manifolds of pairs of convex shapes. Called by the Collide stage, from many threads at
// once.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// The narrow-phase algorithm. Automatic: the fastest exact function of the pair table. Libccd: libccd's GJK and EPA for
// all contacts and queries, for comparison; much slower, and allocates memory. See Docs/Architecture.md.
enum class NarrowPhaseMethod : uint8_t { Automatic, Libccd };
// Whether this build contains libccd. Builds for WebAssembly do not.
bool HasLibccd();

struct CollideSettings {
    float speculativeDistance = 0.02f;  // m, > 0: shapes up to this far apart get contact points
    NarrowPhaseMethod method = NarrowPhaseMethod::Automatic;
};

// Counts failures of libccd; each worker has its own, which are summed in the step's report.
struct CollideCounters {
    // EPA's results were inconsistent from all starts: the best polished axis of EPA, MPR, the center line and the
    // shapes' axes was used.
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
// center-line normal, counted. Allocates only with libccd. Thread-safe.
void Collide(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters);
// The same for a half space b.
void Collide(const ConvexShape& a, const Plane& b, const RelativePose& bInA, const CollideSettings& settings,
             PairCache& cache, Manifold& manifold, CollideCounters& counters);

}  // namespace fulcrum
