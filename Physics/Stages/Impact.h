// How two bodies bounce where a sweep hit one of them: impulses at the points of their manifold, and how both move on
// from there. Called by the Continuous stage, for different hits from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// What a hit makes of hit.body, 0, and hit.other, 1, if it is the next that happens to them.
struct Impact {
    struct Rest {                    // of the step, flown freely
        Vector3 displacement, turn;  // m, rotation vector in rad
        Vector3 linear, angular;     // m/s, rad/s, at its end
    };
    Sweep sweeps[2];                // before
    Pose poses[2];                  // at the time of the hit
    BodyMass masses[2];             // likewise
    Vector3 linear[2], angular[2];  // m/s, rad/s: velocities at the time of the hit, after it
    Vector3 arrivingLinear[2];      // m/s, and
    Vector3 arrivingAngular[2];     // rad/s: before it
    // N s that hit.other got, along the normal by point, and by friction;
    float normalImpulses[SweepHit::kMaxPoints] = {};
    Vector3 frictionImpulse = Vector3::Zero();
    float approachSpeed = 0;  // m/s along the normal, of the point that approached fastest
    Rest rests[2];            // of what can move
    bool bounces = false;     // a point approached
    bool isFinite = false;
};

// What FindImpact reads.
struct ImpactStores {
    const StepContext& step;
    const BodyStore& bodies;
    const ConstraintColoring& coloring;  // whom contacts carried in this step
    const SweepStore& sweeps;
};

// Newton's law of restitution at each point that approaches, Coulomb friction; locked axes and immovable bodies hold.
// Never more energy than before.
Impact FindImpact(const ImpactStores& stores, const SweepHit& hit);

}  // namespace fulcrum
