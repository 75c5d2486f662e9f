#include <Fulcrum/Physics/Stages/Step.h>

#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/Colors.h>

#include <algorithm>
#include <chrono>
#include <iterator>

namespace fulcrum {

namespace {

struct Stage {
    const char* name;
    void (*run)(WorldState& world, StepState& step);
};

// The order in which they run, and what each is given.
constexpr Stage kStages[] = {
    {"UpdateBounds",
     [](WorldState& world, StepState& step) { UpdateBounds(world, step.dt, step.crowd.dispersing, step.findings); }},
    {"FindPairs",
     [](WorldState& world, StepState& step) { FindPairs(world, step.pairs, step.crowd, step.findings, step.scratch); }},
    {"Collide",
     [](WorldState& world, StepState& step) {
         Collide(world, step.dt, step.pairs, step.crowd, step.findings, step.scratch, step.report);
     }},
    {"Color",
     [](WorldState& world, StepState& step) {
         Color(world.bodies.Size(), step.pairs.changes, world.pairs, world.coloring, step.began);
     }},
    {"RemoveSeamContacts",
     [](WorldState& world, StepState& step) {
         RemoveSeamContacts(world.bodies, world.colliders, world.coloring, world.pairs, step.seams, step.scratch);
     }},
    {"BuildIslands",
     [](WorldState& world, StepState& step) {
         const float softness = SoftnessOf(world.settings, step.substepDt);
         NoteWeights(world, step.began, softness);
         BuildIslands(world.bodies, world.coloring, world.pairs, world.settings, softness, world.joints, step.solver,
                      step.scratch);
     }},
    {"Prepare", [](WorldState& world,
                   StepState& step) { Prepare(world, step, step.solver, step.findings, step.scratch, step.report); }},
    {"Solve", Solve},
    {"Store",
     [](WorldState& world, StepState& step) {
         step.sleepCandidates = Store(world, step, step.sweeps, step.broken, step.findings, step.report);
     }},
    {"Continuous", [](WorldState& world,
                      StepState& step) { Continuous(world, step.sweeps, step.findings, step.scratch, step.report); }},
    {"Sense",
     [](WorldState& world, StepState& step) {
         Sense(world, world.sensors, world.colliders, step.sweeps, step.sensing, step.findings, step.report);
     }},
    {"Sleep", [](WorldState& world, StepState& step) { Sleep(world, step.sleepCandidates, step.scratch); }},
};
static_assert(std::size(kStages) == kStageCount, "kStageCount (StepReport.h) is not the number of stages");

using Clock = std::chrono::steady_clock;

double Milliseconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// Forgets the bodies that were removed since the last step, and all pairs that they were part of.
void ForgetRemoved(WorldState& world) {
    if (world.removed.empty() && !world.colliders.movedHasEmpty) return;
    VisitPairsOf(world, world.removed, [&](uint32_t pair) { RemovePair(world.pairs, world.coloring, pair); });
    std::erase_if(world.colliders.moved, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        const bool isGone = !world.colliders.shapes[i].shape || world.bodies.cold[collider.body].removed;
        if (isGone) collider.queued = false;
        return isGone;
    });
    world.colliders.movedHasEmpty = false;
    for (uint32_t body : world.removed) {
        const BodyCold& cold = world.bodies.cold[body];
        world.colliders.Free(cold.firstCollider, cold.colliderCount);
        world.colliders.FreeRuns(cold.MoreColliders());
        world.bodies.Free(body);
    }
    world.removed.clear();
}

void BeginReport(WorldState& world, StepState& step) {
    step.report = {};
    step.report.step = ++world.step;
    step.broken.clear();
    step.sleepCandidates = 0;
    world.sensors.events.clear();
    for (WorkerFindings& f : step.findings) {
        f.libccd = {};
        f.contacts = f.points = f.kept = f.clamped = f.frozen = f.sleepCandidates = 0;
        f.deepest = 0;
        f.deepestPair = f.firstFrozen = ~0u;
        f.joints = {};
    }
}

// A step shorter than this, in seconds, moves nothing that a float could tell; its inverse would only overflow.
constexpr double kShortestStep = 1e-9;

// Impulses of a short step, scaled up to a long one, are mostly its noise: steps that alternate between 1/240 and 1/30
// s threw a stack of six boxes over with no limit, and leave one of ten standing with this one.
constexpr float kMostImpulseScale = 2;

// Of the stiffnessDt of the step before, which a shorter step keeps at least.
constexpr float kStiffnessDecay = 0.95f;

void SetTimes(StepState& step, double dt, const SolverSettings& solver) {
    step.dt = static_cast<float>(dt);
    step.substepDt = step.dt / static_cast<float>(solver.substeps);
    // Springs as stiff as short steps allow would throw apart what long ones let sink.
    step.stiffnessDt = std::max(step.substepDt, kStiffnessDecay * step.stiffnessDt);
    step.impulseScale =
        step.lastSubstepDt > 0 ? std::min(step.substepDt / step.lastSubstepDt, kMostImpulseScale) : 1.0f;
}

void CountBodies(const WorldState& world, const SolverLayout& solver, StepReport& report) {
    report.bodies = world.bodies.Count();
    report.awakeBodies = static_cast<uint32_t>(world.bodies.awake.size());
    report.islands = solver.islands;
    report.pairs = static_cast<uint32_t>(world.pairs.active.Size());
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        report.joints += static_cast<uint32_t>(world.coloring.At(c).Of(ConstraintColoring::Kind::Joint).size());
}

// Notes how long each took.
void RunStages(WorldState& world, StepState& step) {
    const Clock::time_point start = Clock::now();
    Clock::time_point last = start;
    for (size_t i = 0; i < std::size(kStages); ++i) {
        kStages[i].run(world, step);
        const Clock::time_point now = Clock::now();
        step.report.stageMs[i] = Milliseconds(last, now);
        last = now;
    }
    step.report.totalMs = Milliseconds(start, last);
}

}  // namespace

const char* StageName(int stage) { return kStages[stage].name; }

void RunStep(WorldState& world, StepState& step, double dt) {
    ForgetRemoved(world);
    BeginReport(world, step);
    if (dt >= kShortestStep) {
        SetTimes(step, dt, world.settings.solver);
        step.scratch.Reset();
        RunStages(world, step);
        step.lastSubstepDt = step.substepDt;
        world.outsideFatBounds.MarkStale();
        for (const WorkerFindings& f : step.findings) step.report.libccd += f.libccd;
    }
    CountBodies(world, step.solver, step.report);
}

}  // namespace fulcrum
