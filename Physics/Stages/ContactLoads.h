// Measures the loads of contacts and the position errors of joints in small islands; FindIslands gives islands more
// substeps based on them. Updated by StoreImpulses.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/World/PairStore.h>

#include <cmath>
#include <limits>

namespace fulcrum {

// The sink of a contact is its penetration at rest, a consequence of soft rows. A normal force F on a body of mass m,
// the lighter of the two, gives a sink of F / (m w^2), w = 2 pi StiffestFrequency. It is proportional to the square of
// the substep.
struct SinkScale {
    float perLevel;     // 1 / LargestUnnotedSink
    float inverseDt;    // 1/s, of the batch's substeps
    float softness;     // s^2: 1 / w^2 for the system's substeps
    float depthScale;   // (substep of the system's settings / that of its springs)^2: a depth times this is the system's
    Vector3 gravity;    // m/s2
    uint8_t stiffness;  // see LoadLevel
    bool forgets;       // levels may decrease: only in few steps, so that efforts do not alternate
};

// s^2: SinkScale::softness, computed once per step (StepContext).
inline float SoftnessOf(const SystemSettings& settings, float substepDt) {
    const float w = 6.28318531f * std::min(settings.contactFrequency, StiffestFrequency(settings.solver, substepDt));
    return 1.0f / (w * w);
}

// Levels of joint errors assume that the gap is proportional to the square of the substep; if it is not, the efforts
// converge in a few rounds.
struct GapScale {
    float perLevel;  // 1/m: scales a gap with the batch's substeps so that LargestUnnotedGap with the system's substeps
                     // is 1
    uint8_t stiffness;  // see LoadLevel
    bool forgets;       // see SinkScale::forgets
};

// Whether the settings give islands more effort by load.
inline bool AdaptsToLoads(const SystemSettings& settings) {
    return settings.accuracy.penetration < std::numeric_limits<float>::infinity();
}

inline bool AdaptsToGaps(const SystemSettings& settings) {
    return settings.accuracy.jointError < std::numeric_limits<float>::infinity();
}

// Sinks and gaps are quantized to powers of two of a quarter of their target, AccuracyTarget::penetration and
// jointError: level i is below 2^i of that.
constexpr float kUnnotedFraction = 0.25f;
inline float LargestUnnotedSink(const AccuracyTarget& accuracy) { return kUnnotedFraction * accuracy.penetration; }
inline float LargestUnnotedGap(const AccuracyTarget& accuracy) { return kUnnotedFraction * accuracy.jointError; }
// Upper bound of the ratio to the target for a level.
inline float ExcessOfLevel(uint32_t level) { return std::ldexp(kUnnotedFraction, static_cast<int>(level)); }

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

// Initializes the levels of new contacts from the weights of the bodies that they carry: their impulses take many steps
// to build up, the more the lighter the lower body is. began: pairs. Called by BuildIslands.
void NoteWeights(const StepContext& step, std::span<const uint32_t> began, const BodyStore& bodies,
                 const JointStore& joints, PairStore& pairs);

// Updates the load levels of a batch's pairs from their sinks. Loads must persist for some steps. Contacts of jointed
// bodies, whose size is undefined, are left out. Returns whether any level changed.
template <int N, bool kFixedB>
bool NoteSinks(const ContactBatch<N, kFixedB>& batch, const SinkScale& scale, const BodyStore& bodies,
               const JointStore& joints, PairStore& pairs);

// Updates the levels of a batch's joints from their position errors at the start of the step. Returns whether any level
// changed.
template <int N>
bool NoteGaps(const JointBatch<N>& batch, const GapScale& scale, std::span<LoadLevel> gaps);
template <int N>
bool NoteGaps(const BallBatch<N>& batch, const GapScale& scale, std::span<LoadLevel> gaps);

}  // namespace fulcrum
