// The solver settings of a group of islands: the system's, or more effort if its joints ask for it, or it is a wall.
// Used by Prepare, Solve, Store.
#pragma once

#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/Stages/StepContext.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

struct Effort {
    SolverSettings solver;
    // Of the velocity iterations the first so many solve impacts, with friction, and leave overlaps as they are
    // (ContactSolveSettings::StopRecovery).
    int impactIterations;
    float substepDt;  // s
    float
        impulseScale;  // scales impulses in records, which are those of the system's substeps, to the group's substeps
    bool startsAnew;   // contacts are warm started explicitly in every substep
    ContactSolveSettings contacts;
    JointSolveSettings joints;
};

// Hz, largest frequency of soft contacts and joints for a substep of h seconds with this many iterations. Above (w h)^2
// = iterations the slow modes of stacks and chains, of which an iteration resolves little, gain energy (derived in
// Docs/Step.md); this is (w h)^2 = 0.88 iterations.
inline float StiffestFrequency(const SolverSettings& solver, float h) {
    return std::sqrt(static_cast<float>(solver.velocityIterations + solver.positionIterations) / 45.0f) / h;
}

// Minimum damping ratio of soft contacts with this frequency, Hz. The stiffer springs of more substeps would separate
// bodies faster and leave more of that in the velocities. So they are damped more, such that they remove at most a
// hundredth of an overlap in 0.1 ms, as with four substeps; but not so much that impulseScale becomes tiny and slow
// modes are hardly damped.
inline float LeastDampingRatio(float frequency, float h) {
    constexpr float kMostPushRate = 100;  // 1/s
    constexpr float kMost = 2.5f;
    const float w = 6.28318531f * frequency;
    return std::min(0.5f * (w / kMostPushRate - h * w), kMost);
}

// ContactSolveSettings::mostError for steps of dt seconds: 0.3 inner radii of the smaller body per second; in steps
// longer than 1/60 s an error that deepens an overlap by as much in a step. inverseSoftDepth is in quarters of the
// radius.
inline float MostVelocityError(float dt) { return 0.02f / std::max(dt, 1.0f / 60); }
// ContactSolveSettings::hitError for substeps of h seconds: what deepens an overlap by a tenth of the radius in one.
inline float HitError(float h) { return 0.4f / h; }

// Loads are judged over so many steps of 1/60 s, or longer steps, or over the same time in shorter ones.
inline uint32_t StepsFor(uint32_t steps, const StepContext& step) {
    constexpr float kMost = 255;
    const float dt = step.stiffnessDt * static_cast<float>(step.settings.solver.substeps);
    return static_cast<uint32_t>(
        std::clamp(static_cast<float>(steps) / (60 * dt) + 0.5f, static_cast<float>(steps), kMost));
}

// s. In shorter substeps the rounding of velocities in floats counts.
inline constexpr float kShortSubstep = 1.0f / 1000;

// Of an island under load that is solved directly. In short substeps floats of velocities and impulses resolve too
// little of its motion: a column that leaned by 97 % of what it stands fell with 128.
inline int DirectSubsteps(int substeps, float dt, bool isResting) {
    return isResting ? 1 : std::clamp(static_cast<int>(dt / kShortSubstep), 1, substeps);
}

inline Effort EffortOf(const StepContext& step, const SolverGroup& group) {
    const SystemSettings& s = step.settings;
    Effort effort;
    effort.solver = s.solver;
    effort.solver.substeps = std::max<int>(s.solver.substeps, group.effort.substeps);
    if (group.isLoaded) effort.solver.substeps = DirectSubsteps(effort.solver.substeps, step.dt, group.isResting);
    effort.solver.velocityIterations = std::max<int>(s.solver.velocityIterations, group.effort.velocityIterations);
    effort.solver.positionIterations = std::max<int>(s.solver.positionIterations, group.effort.positionIterations);
    const float h = effort.substepDt = step.dt / static_cast<float>(effort.solver.substeps);
    // What is carried over takes each rounding of a velocity for an impulse, in every substep again: errors are
    // integrated twice. By the settings alone: islands with more effort of their own are piles, which lose by it.
    effort.startsAnew = group.hasJoints || step.dt < kShortSubstep * static_cast<float>(s.solver.substeps);
    effort.impulseScale = h / step.substepDt;
    const float stiffest = StiffestFrequency(effort.solver, step.stiffnessDt * effort.impulseScale);

    ContactSolveSettings& contacts = effort.contacts;
    contacts.inverseDt = 1.0f / h;
    contacts.elapsed = 0;
    contacts.slop = s.penetrationSlop;
    contacts.restitutionSpeed = s.restitutionSpeed;
    contacts.mostError = MostVelocityError(step.dt);
    contacts.hitError = HitError(h);
    contacts.leastError = Length(s.gravity) * step.dt;
    const float frequency = std::min(s.contactFrequency, stiffest);
    contacts.Soften(frequency, std::max(s.contactDampingRatio, LeastDampingRatio(frequency, h)), h, s.contactPushSpeed);

    JointSolveSettings& joints = effort.joints;
    joints.dt = step.dt;
    joints.substepDt = h;
    joints.inverseDt = 1.0f / h;
    joints.elapsed = 0;
    joints.impulseScale = step.impulseScale * effort.impulseScale;
    const bool corrects = s.solver.positionCorrection == PositionCorrection::Baumgarte;
    contacts.relaxes = !corrects && effort.solver.positionIterations > 0;
    effort.impactIterations = contacts.relaxes ? s.solver.velocityIterations / 2 : 0;
    contacts.baumgarte = joints.baumgarte = s.solver.baumgarte;
    contacts.mostCorrection = s.contactPushSpeed * h;
    if (corrects) {
        contacts.slop = std::max(s.penetrationSlop, s.solver.baumgarteSlop);
        contacts.pushRate = contacts.stiffening = contacts.impulseScale = 0;
        contacts.massScale = 1;
    }
    // With joints, overlaps are corrected in the poses, too: a push against rows that iterations do not satisfy would
    // part the joints, and a heavy load would be lifted again and again.
    if (group.isLoaded) contacts.slop = s.penetrationSlop;
    if (group.hasJoints && !corrects) {
        contacts.StopRecovery();
        if (!group.isLoaded) contacts.slop = std::max(s.penetrationSlop, s.solver.baumgarteSlop);
        effort.impactIterations = 0;
        contacts.mostCorrection = std::max(s.contactPushSpeed, s.jointPushSpeed) * h;
    }
    joints.maxPushSpeed = s.jointPushSpeed;
    joints.sleepSeconds = s.sleep.seconds;
    joints.isDirect = group.isDirect;
    joints.leavesLocks = joints.continues = false;
    return effort;
}

}  // namespace fulcrum
