// Statistics of a step: sizes, times, worst cases. Filled by PhysicsSystem::Update.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>

#include <array>

namespace fulcrum {

// Stages are numbered 0..kStageCount - 1 in their order. Their list is in Physics/Stages/Step.cpp.
inline constexpr int kStageCount = 13;
const char* StageName(int stage);

// An island that was solved with more effort than the settings', and its effort.
struct IslandEffortReport {
    int substeps = 0, velocityIterations = 0, positionIterations = 0;
    // The body that required it: the one that would exceed AccuracyTarget most, the lighter one of its contact; or a
    // body of a joint that asks for more effort, or of a load.
    BodyId culprit;
    uint32_t bodies = 0;  // dynamic ones in it
    // Its contacts are solved directly, because of a load: in the settings' substeps, in none shorter than a
    // millisecond, and, at rest, in one.
    bool isDirect = false;
};

// What a step made of energy and momentum, summed in double. Measured where SystemSettings::measuresErrors asks for it;
// depths and gaps are in every report. An island is what contacts, joints and hits of the step connect.
struct StepErrors {
    bool areMeasured = false;  // else all is zero
    // J: by how much the mechanical energy of all awake dynamic bodies (kinetic, and potential in gravity) changed,
    // less the work of applied forces and torques. Friction, impacts and damping take some away.
    double energyChange = 0;
    // J, >= 0: the largest rise of that energy in one island that nothing kinematic touches. Motors and springs of
    // joints give it rightly; all else is an error.
    double energyGain = 0;
    BodyId mostGaining;  // of that island the body whose own energy rose most
    // N s and N m s, >= 0: the largest change of momentum, and of angular momentum about the center of mass, in one
    // island that nothing outside holds (nothing immovable, locked axes, damping, gears, pulleys), beyond what gravity
    // and applied forces explain.
    double momentumError = 0, angularMomentumError = 0;
    BodyId momentumBody, angularMomentumBody;  // of these islands the body whose own changed most
    // J, >= 0: kinetic energy of the velocities with which a substep moved bodies and which they do not keep, as those
    // out of overlaps and gaps of joints: of each body in the substep with the most of it; their sum, and the largest.
    double pushEnergy = 0, largestPushEnergy = 0;
    BodyId mostPushed;
};

struct StepReport {
    uint64_t step = 0;                          // 1 for the first
    double totalMs = 0;                         // wall clock
    std::array<double, kStageCount> stageMs{};  // wall clock by stage
    uint32_t bodies = 0, awakeBodies = 0;
    uint32_t pairs = 0;                        // of colliders whose fat bounds overlap, awake ones
    uint32_t contacts = 0, contactPoints = 0;  // manifolds with at least one point, awake ones
    uint32_t keptManifolds = 0;                // of these, reused from the last step
    uint32_t joints = 0;                       // awake ones
    // m and rad, >= 0: the largest errors of joints, as JointInterface::GetError has them, at the start of the step.
    float largestJointError = 0, largestJointAngle = 0;
    JointId worstJoint, mostTurnedJoint;
    uint32_t colors = 0, overflowConstraints = 0;  // overflow: without a color, solved serially
    uint32_t islands = 0;                          // awake ones with constraints
    uint32_t islandsWithMoreEffort = 0;            // than the settings'
    // The islands with the most substeps, then iterations, the greatest effort first; unused entries are zero.
    std::array<IslandEffortReport, 4> mostEffort{};
    float largestPenetration = 0;  // m, >= 0, as found by Collide
    BodyId deepestA, deepestB;
    CollideCounters libccd;
    // Bodies that were stopped because their state was not finite. They are frozen; but if only the velocity computed
    // by constraints was not finite, they are at rest at their pose before the step, and continue in the next.
    uint32_t frozenBodies = 0;
    BodyId firstFrozen;                          // the one with the lowest index
    uint32_t sweptBodies = 0, sweptHits = 0;     // continuous collision: bodies that were cast, and hits
    uint32_t sensorTests = 0, sensorEvents = 0;  // pairs of a sensor and a body whose shapes were tested; events
    uint32_t clampedBodies = 0;                  // bodies that were clamped to their speed limits
    StepErrors errors;
};

}  // namespace fulcrum
