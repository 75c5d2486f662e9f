// How two bodies part where a sweep hit one of them: impulses at the points of their manifold. Called by the Continuous stage, for
// different hits from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

// What a hit makes of hit.body, 0, and hit.other, 1, if it is the next that happens to them.
struct Impact {
    Sweep courses[2];                          // before
    Pose poses[2];                             // at the time of the hit
    BodyMass masses[2];                        // likewise
    Vector3 gain[2];                           // m/s, that gravity and forces still add to the velocity until the end of the step
    Vector3 linear[2], angular[2];             // m/s, rad/s: velocities after the hit
    bool parts = false;                        // a point approached; else velocities are those before the hit
    bool lasts = false;                        // nothing but a change of one of the two courses changes what is said here
};

// Newton's law of restitution at each point that approaches, Coulomb friction, what is locked or does not move held. dt, s: of the step.
Impact FindImpact(const WorldState& world, const SweepHit& hit, float dt);

}  // namespace fulcrum
