// Resolves a hit of continuous collision: impulses at the points of the manifold, and the motion of both bodies after
// it. Called by the Continuous stage, for different hits from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// The result of a hit for hit.body, index 0, and hit.other, index 1, if it is their next one.
struct Impact {
    struct Rest {                    // free motion for the rest of the step
        Vector3 displacement, turn;  // m, rotation vector in rad
        Vector3 linear, angular;     // m/s, rad/s, at the end of the step
    };
    Sweep sweeps[2];                // before the hit
    Pose poses[2];                  // at the time of the hit
    BodyMass masses[2];             // at the time of the hit
    Vector3 linear[2], angular[2];  // m/s, rad/s: velocities at the time of the hit, after it
    Vector3 arrivingLinear[2];      // m/s, and
    Vector3 arrivingAngular[2];     // rad/s: before it
    // N s on hit.other, along the normal by point, and by friction;
    float normalImpulses[SweepHit::kMaxPoints] = {};
    Vector3 frictionImpulse = Vector3::Zero();
    float approachSpeed = 0;  // m/s along the normal, of the point that approached fastest
    Rest rests[2];            // for dynamic bodies
    bool bounces = false;     // whether a point approached
    bool isFinite = false;
};

// Inputs of FindImpact.
struct ImpactStores {
    const StepContext& step;
    const BodyStore& bodies;
    const ConstraintColoring& coloring;  // which bodies contacts carried in this step
    const SweepStore& sweeps;
};

// Newton's law of restitution at each approaching point and Coulomb friction; respects locked axes and immovable
// bodies. Never increases energy.
Impact FindImpact(const ImpactStores& stores, const SweepHit& hit);

}  // namespace fulcrum
