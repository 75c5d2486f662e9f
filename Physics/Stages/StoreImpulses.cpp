// Writes the impulses of the batches back to the records of contacts and joints, and updates their load levels.
#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/FindIslands.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace fulcrum {

namespace {

// Destination of the impulses. Bodies are only read.
struct Records {
    const BodyStore& bodies;
    PairStore& pairs;
    JointStore& joints;
};

// Scales for storing the batches of a group.
struct StoreScale {
    float dt, substepDt;    // s, of the step and of the batch's substeps
    float impulseScale;     // see Effort
    const SinkScale* sink;  // for contacts; null if load levels are off
    const GapScale* gap;    // for joints; null if none has a target
};

// Returns whether a joint began to be strained or past a limit.
template <class Batch>
bool NoteStrained(const Batch& batch, JointStore& joints) {
    bool began = false;
    const auto note = [&](uint32_t lanes, bool Joint::*flag) {
        for (; lanes != 0; lanes &= lanes - 1)
            began |= !std::exchange(joints.joints[batch.joint[std::countr_zero(lanes)]].*flag, true);
    };
    note(batch.strained, &Joint::isStrained);
    note(batch.pastLimit, &Joint::wasPastLimit);
    return began;
}

template <int N, bool kFixedB>
void StoreBatch(const Records& to, const ContactBatch<N, kFixedB>& batch, const StoreScale& scale,
                WorkerFindings& findings) {
    StoreContacts(batch, to.pairs.records.data(), scale.impulseScale);
    if (scale.sink) findings.loadsChanged |= NoteSinks(batch, *scale.sink, to.bodies, to.joints, to.pairs);
}
template <int N>
void StoreBatch(const Records& to, const JointBatch<N>& batch, const StoreScale& scale, WorkerFindings& findings) {
    StoreJoints(batch, to.joints.records.data(), to.joints.types.data(), to.bodies.states.data(), scale.dt,
                scale.impulseScale);
    NoteRowErrors(batch, to.joints.types.data(), scale.substepDt, findings.joints);
    if (scale.gap) findings.strainsBegan |= NoteGaps(batch, *scale.gap, to.joints);
    findings.strainsBegan |= NoteStrained(batch, to.joints);
}
template <int N>
void StoreBatch(const Records& to, const BallBatch<N>& batch, const StoreScale& scale, WorkerFindings& findings) {
    StoreJoints(batch, to.joints.records.data(), scale.dt, scale.impulseScale);
    if (scale.gap) findings.strainsBegan |= NoteGaps(batch, *scale.gap, to.joints);
}

template <class Batch>
void StoreAll(const Records& to, const Array<Batch>& batches, uint32_t begin, uint32_t end, const StoreScale& scale,
              const StepWorkers& workers) {
    workers.jobs.ParallelFor(end - begin, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            StoreBatch(to, batches[begin + i], scale, workers.findings[range.worker]);
    });
}

void FindWorstJoints(const JointStore& joints, std::span<const WorkerFindings> workers, StepReport& report) {
    JointFindings worst;
    const auto note = [](float error, uint32_t joint, float& largest, uint32_t& which) {
        if (joint == ~0u || error < largest || (error == largest && joint >= which)) return;
        largest = error;
        which = joint;
    };
    for (const WorkerFindings& findings : workers) {
        note(findings.joints.linearError, findings.joints.linearJoint, worst.linearError, worst.linearJoint);
        note(findings.joints.angularError, findings.joints.angularJoint, worst.angularError, worst.angularJoint);
    }
    report.largestJointError = worst.linearError;
    report.largestJointAngle = worst.angularError;
    if (worst.linearJoint != ~0u) report.worstJoint = joints.IdOf(worst.linearJoint);
    if (worst.angularJoint != ~0u) report.mostTurnedJoint = joints.IdOf(worst.angularJoint);
}

// Whether some island that waits to be calm is: then it is to be solved directly.
bool IsAnyCalm(const StepContext& step, const BodyStore& bodies, const SolverLayout& layout, ScratchArena& scratch) {
    if (layout.waiting.empty()) return false;
    const float calm = CalmSpeed(step.settings);
    std::span<bool> isMoving = scratch.Allocate<bool>(layout.efforts.size());
    std::ranges::fill(isMoving, false);
    for (const auto& [island, body] : layout.waiting)
        isMoving[island] = isMoving[island] || !(Length(bodies.LinearVelocityOf(body)) < calm);
    return std::any_of(layout.waiting.begin(), layout.waiting.end(),
                       [&](const WaitingBody& waiting) { return !isMoving[waiting.island]; });
}

// Period in steps in which load levels may decrease, see StepsFor.
constexpr uint32_t kStepsToForget = 16;

}  // namespace

// Batches of groups are contiguous: consecutive groups without an effort of their own are stored together.
void StoreImpulses(const StepContext& step, const BodyStore& bodies, const SolverLayout& layout, PairStore& pairs,
                   JointStore& joints, const StepWorkers& workers, StepReport& report) {
    const SystemSettings& settings = step.settings;
    const Records to{bodies, pairs, joints};
    const bool notesSinks = AdaptsToLoads(settings, bodies), notesGaps = AdaptsToGaps(settings, joints);
    const uint8_t stepsOfLoad = StepsOfLoad(step);
    const bool forgets = step.number % StepsFor(kStepsToForget, step) == 0;
    const bool notesLarge = layout.OverflowCount() > 0;
    const GapScale gaps{settings.accuracy.jointError, stepsOfLoad};
    const auto sinkScaleOf = [&](float impulseScale) {  // see Effort
        return SinkScale{settings.accuracy.penetration, 1 / (step.substepDt * impulseScale), LoadSoftnessOf(step),
                         stepsOfLoad, forgets};
    };
    uint32_t stored[kBatchKinds] = {};
    const auto storeTo = [&](auto&& endOf, const StoreScale& scale) {
        ForEachBatchList(layout, [&](const auto& list, BatchKind kind) {
            const uint32_t end = endOf(list, kind);
            StoreAll(to, list.batches, stored[kind], end, scale, workers);
            stored[kind] = end;
        });
    };
    const SinkScale usualSink = sinkScaleOf(1);
    const StoreScale usual{step.dt, step.substepDt, 1, notesSinks ? &usualSink : nullptr, notesGaps ? &gaps : nullptr};
    for (const SolverGroup& group : layout.groups) {
        const bool isFirst = &group == &layout.groups.front();
        if (!group.isLarge && !group.effort.IsAny() && !group.isLoaded) continue;
        const float impulseScale = EffortOf(step, group).impulseScale;
        const SinkScale sink = sinkScaleOf(impulseScale);
        const bool isNoted = notesLarge || !group.isLarge;
        const StoreScale scale{step.dt, step.substepDt * impulseScale, impulseScale,
                               isNoted && notesSinks ? &sink : nullptr, usual.gap};
        if (isFirst)
            ForEachOverflowList(layout, [&](const auto& batches) {
                StoreAll(to, batches, 0, static_cast<uint32_t>(batches.size()), scale, workers);
            });
        if (group.colorsBegin == group.colorsEnd) continue;
        const ColorBatches &first = layout.colors[group.colorsBegin], &last = layout.colors[group.colorsEnd - 1];
        storeTo([&](const auto&, BatchKind kind) { return first.of[kind].begin; }, usual);
        storeTo([&](const auto&, BatchKind kind) { return last.of[kind].end; }, scale);
    }
    storeTo([](const auto& list, BatchKind) { return list.count; }, usual);
    FindWorstJoints(joints, workers.findings, report);
    pairs.loadVersion += IsAnyCalm(step, bodies, layout, workers.scratch);
    for (WorkerFindings& findings : workers.findings) {
        joints.strainVersion += findings.strainsBegan;
        pairs.loadVersion += findings.loadsChanged || findings.strainsBegan;
        findings.loadsChanged = findings.strainsBegan = false;
    }
}

}  // namespace fulcrum
