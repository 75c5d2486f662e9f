// Measures the loads of contacts in small islands, and the gaps of joints with a target: FindIslands has islands solved
// directly because of them. Updated by StoreImpulses.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/World/PairStore.h>
#include <Fulcrum/Physics/World/TargetChanges.h>

#include <cmath>
#include <limits>

namespace fulcrum {

// Sinks are quantized to powers of two of a quarter of their target, AccuracyTarget::penetration: level i is below 2^i
// of that.
constexpr float kUnnotedFraction = 0.25f;
inline float LargestUnnoted(float target) { return kUnnotedFraction * target; }
// Upper bound of the ratio to the target for a level.
inline float ExcessOfLevel(uint32_t level) { return std::ldexp(kUnnotedFraction, static_cast<int>(level)); }

// The sink of a contact is its penetration at rest, a consequence of soft rows. A normal force F on a body of mass m,
// the lighter of the two, gives a sink of F / (m w^2), w = 2 pi StiffestFrequency. It is proportional to the square of
// the substep.
struct SinkScale {
    float target;         // AccuracyTarget::penetration
    float inverseDt;      // 1/s, of the batch's substeps
    float softness;       // s^2: LoadSoftnessOf
    uint8_t stepsOfLoad;  // see StepsOfLoad
    bool forgets;         // levels may decrease: only in few steps, so that solutions do not alternate
};

// A load must persist for this many steps; shorter ones are impacts, or piles that come to rest.
inline uint8_t StepsOfLoad(const StepContext& step) { return static_cast<uint8_t>(StepsFor(8, step)); }

// s^2: SinkScale::softness, computed once per step (StepContext).
inline float SoftnessOf(const SystemSettings& settings, float substepDt) {
    const float w = 6.28318531f * std::min(settings.contactFrequency, StiffestFrequency(settings.solver, substepDt));
    return 1.0f / (w * w);
}
// The same, by which loads are judged: that of substeps of 1/240 s at least. What needs a direct solution there gets it
// with shorter substeps, too: they are not to be less exact.
inline float LoadSoftnessOf(const StepContext& step) {
    constexpr float kUsual = 1.0f / 240;
    return step.stiffnessDt < kUsual ? SoftnessOf(step.settings, kUsual) : step.softness;
}

// AccuracyTarget::jointError.
struct GapScale {
    float target;         // m
    uint8_t stepsOfLoad;  // see StepsOfLoad
};

// Whether islands are solved directly by what they carry, and by the gaps of their joints.
inline bool AdaptsToLoads(const SystemSettings& settings, const BodyStore& bodies) {
    return settings.accuracy.penetration < std::numeric_limits<float>::infinity() || bodies.targetCount > 0;
}
inline bool AdaptsToGaps(const SystemSettings& settings, const JointStore& joints) {
    return settings.accuracy.jointError < std::numeric_limits<float>::infinity() || joints.targetCount > 0;
}

// AccuracyTarget::penetration of two bodies, or what they have in its place.
inline float PenetrationTargetOf(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB, float system) {
    if (bodies.targetCount == 0) return system;
    return PenetrationTargetOf(bodies.cold[bodyA].penetrationTarget, bodies.cold[bodyB].penetrationTarget, system);
}

// m^2: the square of half the edge of a cube with the same inverse mass and sum of inverse moments of inertia.
// Infinite if rotation is locked.
template <class Real>
Real SquaredSize(const Real& inverseMass, const Real& inverseInertia) {
    return Real(4.5f) * inverseMass / inverseInertia;
}
inline float SquaredSizeOf(const BodyDynamics& body) {
    const float* inertia = body.inverseInertia;
    return SquaredSize(body.inverseMass, inertia[0] + inertia[1] + inertia[2]);
}
inline float SizeOf(const BodyDynamics& body) { return std::sqrt(SquaredSizeOf(body)); }

// Initializes the levels of new contacts from the weights that they carry, in a structure that begins at rest those of
// all bodies above: their impulses take many steps to build up, the more the lighter the lower body is. began: pairs.
// Called by BuildIslands.
void NoteWeights(const StepContext& step, std::span<const uint32_t> began, const BodyStore& bodies,
                 const JointStore& joints, PairStore& pairs, ScratchArena& scratch);

// The same by the forces of the last step, where the step is longer: its softer springs would let stacks fall by
// several sinks. Called by BuildIslands.
void NoteForces(const StepContext& step, const ConstraintColoring& coloring, const BodyStore& bodies,
                const JointStore& joints, PairStore& pairs);

// Updates the load levels of a batch's pairs from their sinks. Loads must persist for some steps. Contacts of jointed
// bodies, whose size is undefined, are left out. Returns whether any level changed.
template <int N, bool kFixedB>
bool NoteSinks(const ContactBatch<N, kFixedB>& batch, const SinkScale& scale, const BodyStore& bodies,
               const JointStore& joints, PairStore& pairs);

// Marks the joints of a batch whose gap has exceeded its target for some steps (Joint::isBeyondTarget). Returns whether
// there is a new one.
template <int N>
bool NoteGaps(const JointBatch<N>& batch, const GapScale& scale, JointStore& joints);
template <int N>
bool NoteGaps(const BallBatch<N>& batch, const GapScale& scale, JointStore& joints);

}  // namespace fulcrum
