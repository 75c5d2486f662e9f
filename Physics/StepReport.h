// What a step did: sizes, times, the worst culprits. Filled by PhysicsSystem::Update.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>

#include <array>

namespace fulcrum {

// The stages of a step have numbers, 0 .. kStageCount - 1, in their order. Their list is in Physics/Stages/Step.cpp.
inline constexpr int kStageCount = 13;
const char* StageName(int stage);

// An island that was solved with more than the settings' numbers, and what it was solved with.
struct IslandEffortReport {
    int substeps = 0, velocityIterations = 0, positionIterations = 0;
    // For whom: the body that would sink deepest beyond AccuracyTarget, the lighter one of its contact; or one of a
    // joint that asks for more, or of a tree of joints that carries much.
    BodyId culprit;
};

struct StepReport {
    uint64_t step = 0;                          // 1 for the first
    double totalMs = 0;                         // wall clock
    std::array<double, kStageCount> stageMs{};  // wall clock by stage
    uint32_t bodies = 0, awakeBodies = 0;
    uint32_t pairs = 0;                        // of colliders whose fat bounds overlap, awake ones
    uint32_t contacts = 0, contactPoints = 0;  // manifolds with at least one point, awake ones
    uint32_t keptManifolds = 0;                // of these, not collided anew
    uint32_t joints = 0;                       // awake ones
    float largestJointError = 0;               // m, >= 0: between the anchors of locks, as the step began
    float largestJointAngle = 0;               // rad, >= 0
    JointId worstJoint, mostTurnedJoint;
    uint32_t colors = 0, overflowConstraints = 0;  // overflow: fitted no color, solved one by one
    uint32_t islands = 0;                          // awake ones that something touches
    uint32_t islandsWithMoreEffort = 0;            // than the settings'
    // Of them those with the most substeps, then iterations, the greatest effort first; beyond their number zeros.
    std::array<IslandEffortReport, 4> mostEffort{};
    float largestPenetration = 0;  // m, >= 0, as found by Collide
    BodyId deepestA, deepestB;
    CollideCounters libccd;
    // Bodies that were stopped because numbers of theirs were not finite: frozen, where these were their own; where
    // only what constraints made of their motion was, they are at rest where the step found them, and go on in the
    // next.
    uint32_t frozenBodies = 0;
    BodyId firstFrozen;                          // the one with the lowest index
    uint32_t sweptBodies = 0, sweptHits = 0;     // of continuous collision: bodies that were cast, and what they hit
    uint32_t sensorTests = 0, sensorEvents = 0;  // pairs of a sensor and a body whose shapes were looked at; events
    uint32_t clampedBodies = 0;                  // bodies that were held to their largest speeds
};

}  // namespace fulcrum
