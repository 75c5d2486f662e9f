// How much the contacts of small islands carry, and how far the anchors of their joints are apart, by which FindIslands
// gives an island more substeps. Measured by StoreImpulses.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/World/PairStore.h>

#include <cmath>
#include <limits>

namespace fulcrum {

// The sink of a contact: how deep its bodies overlap at rest because its rows are soft. A normal force F that presses a
// body of mass m sinks it by F / (m w^2), w = 2 pi StiffestFrequency; of the two bodies the lighter one counts. It
// falls with the square of the substep.
struct SinkScale {
    float perLevel;     // 1 / LargestUnnotedSink
    float inverseDt;    // 1/s, of the substeps in which the batch was solved
    float softness;     // s^2: 1 / w^2 for the system's substeps
    float depthScale;   // (substep of the system's settings / that of its springs)^2: a depth times this is the system's
    Vector3 gravity;    // m/s2
    uint8_t stiffness;  // see LoadLevel
    bool forgets;       // loads that are less than they were are noted: in few steps, so that no effort comes and goes
};

// s^2: SinkScale::softness, which a step finds once (StepContext).
inline float SoftnessOf(const SystemSettings& settings, float substepDt) {
    const float w = 6.28318531f * std::min(settings.contactFrequency, StiffestFrequency(settings.solver, substepDt));
    return 1.0f / (w * w);
}

// How far the anchors of a joint are apart is noted as if the gap fell with the square of the substep; where it falls
// otherwise, efforts find their place in a few rounds.
struct GapScale {
    float perLevel;     // 1/m: a gap in the batch's substeps times this is 1 where the system's leave LargestUnnotedGap
    uint8_t stiffness;  // see LoadLevel
    bool forgets;       // as SinkScale::forgets
};

// Whether islands get more effort by what they carry.
inline bool HeedsLoads(const SystemSettings& settings) {
    return settings.accuracy.penetration < std::numeric_limits<float>::infinity();
}

inline bool HeedsGaps(const SystemSettings& settings) {
    return settings.accuracy.jointError < std::numeric_limits<float>::infinity();
}

// Sinks, and gaps, are noted as powers of two of a quarter of what they may be, AccuracyTarget::penetration and
// jointError: level i is below 2^i of it.
constexpr float kUnnotedPart = 0.25f;
inline float LargestUnnotedSink(const AccuracyTarget& accuracy) { return kUnnotedPart * accuracy.penetration; }
inline float LargestUnnotedGap(const AccuracyTarget& accuracy) { return kUnnotedPart * accuracy.jointError; }
// How many times more than it may be what has a level can be.
inline float ExcessOfLevel(uint32_t level) { return std::ldexp(kUnnotedPart, static_cast<int>(level)); }

// m^2: the square of half the edge of a cube with the same inverse mass and sum of inverse moments of inertia.
// Infinite where rotation is locked.
template <class Real>
Real SquaredSize(const Real& inverseMass, const Real& inverseInertia) {
    return Real(4.5f) * inverseMass / inverseInertia;
}
inline float SquaredSizeOf(const BodyDynamics& body) {
    const float* inertia = body.inverseInertia;
    return SquaredSize(body.inverseMass, inertia[0] + inertia[1] + inertia[2]);
}
inline float SizeOf(const BodyDynamics& body) { return std::sqrt(SquaredSizeOf(body)); }

// Notes the weights of bodies that have come to lie on others: the impulses of such contacts tell only after many steps
// what they are to carry, the more the lighter the lower body is. began: pairs. Called by BuildIslands.
void NoteWeights(const StepContext& step, std::span<const uint32_t> began, const BodyStore& bodies,
                 const JointStore& joints, PairStore& pairs);

// Notes the sinks of a batch in the loads of its pairs. What does not last for some steps is no load. Contacts of
// bodies with joints, which have no size of their own, are left out. Returns whether some level has changed.
template <int N, bool kFixedB>
bool NoteSinks(const ContactBatch<N, kFixedB>& batch, const SinkScale& scale, const BodyStore& bodies,
               const JointStore& joints, PairStore& pairs);

// Notes how far the anchors of a batch's joints were apart as the step began. Returns whether some level has changed.
template <int N>
bool NoteGaps(const JointBatch<N>& batch, const GapScale& scale, std::span<LoadLevel> gaps);
template <int N>
bool NoteGaps(const BallBatch<N>& batch, const GapScale& scale, std::span<LoadLevel> gaps);

}  // namespace fulcrum
