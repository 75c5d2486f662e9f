// How two bodies part where a sweep hit one of them: impulses at the points of their manifold. Called by the Continuous stage, serially.
#pragma once

#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

// The velocities of two bodies at the time of the hit, m/s and rad/s.
struct ImpactVelocities {
    Vector3 linear[2], angular[2];  // of hit.body, hit.other
};

// By the masses and the world inertia of the bodies as they are. Newton's law of restitution at each point that approaches, Coulomb friction, what is locked or does not move held. False: no point
// approaches, and nothing has changed.
bool SolveImpact(const WorldState& world, const SweepHit& hit, ImpactVelocities& velocities);

}  // namespace fulcrum
