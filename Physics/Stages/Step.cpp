#include <Fulcrum/Physics/Stages/Step.h>

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/StepObserver.h>
#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/PutIntoSleepers.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/SteadyPushes.h>
#include <Fulcrum/Physics/World/Teleports.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <tuple>
#include <utility>

namespace fulcrum {

namespace {

struct Stage {
    const char* name;
    void (*run)(WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers);
};

// Finds the pairs of bodies that moved or woke.
void FindPairsOf(WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
    FindPairs(step, world.joints, world.bodies, world.colliders, world.pairs, world.coloring, state.pairs, state.crowd,
              workers);
    ForgetMoved(world.colliders, world.sensors, workers.jobs);
}

// Bodies into which something was put search for pairs at once, too.
void FindAllPairs(WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
    FindPairsOf(world, state, step, workers);
    while (WakePutInto(state.findings, world)) FindPairsOf(world, state, step, workers);
}

void SettleStoppedIn(WorldState& world, const StepWorkers& workers) {
    SettleStopped(workers.findings, world.colliders, world.bodies, world.pairs, world.joints, world.coloring);
}

// The stages in the order in which they run, with their arguments. Queries of other threads are let in between the
// first and the Store stage, and in Continuous: what they read does not change there (WorldLock.h, SeenPoses.h).
constexpr Stage kStages[] = {
    {"UpdateBounds",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         UpdateBounds(step, world.pairs, world.sensors, world.bodies, world.colliders, state.crowd.dispersing, workers);
         SettleStoppedIn(world, workers);
         world.outsideFatBounds.Clear();
         world.lock.LetQueriesIn();
     }},
    {"FindPairs", FindAllPairs},
    {"Collide",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         Collide(step, world.bodies, world.colliders, world.joints, world.coloring, world.pairs, state.pairs, workers,
                 state.report);
         // Woken bodies search for pairs at once: they must not lose their support for a step.
         while (WakeHit(world.pairs, state.pairs.changes, world)) {
             FindPairsOf(world, state, step, workers);
             if (state.pairs.activated.empty()) break;
             CollideActivated(step, world.bodies, world.colliders, world.joints, world.coloring, world.pairs,
                              state.pairs, workers, state.report);
         }
         GatherCrowd(step, world.bodies, state.crowd, workers.findings);
     }},
    {"Color",
     [](WorldState& world, StepState& state, const StepContext&, const StepWorkers&) {
         Color(world.bodies.Size(), state.pairs.changes, world.pairs, world.coloring, state.began);
     }},
    {"RemoveSeamContacts",
     [](WorldState& world, StepState& state, const StepContext&, const StepWorkers& workers) {
         RemoveSeamContacts(world.bodies, world.colliders, world.coloring, world.pairs, state.seams, workers.scratch);
     }},
    {"BuildIslands",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         BuildIslands(step, world.bodies, world.coloring, state.began, world.pairs, world.joints, state.solver,
                      state.savedEfforts, workers.scratch);
     }},
    {"Prepare",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         Prepare(step, world.bodies, world.coloring, state.crowd, world.pairs, world.joints, state.solver, workers,
                 state.report);
     }},
    {"Solve",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         if (step.settings.measuresErrors) BeginErrors(step, world.bodies, state.errors);
         Solve(step, world.colliders, world.pairs, world.joints, world.coloring, world.bodies, state.solver,
               step.settings.measuresErrors ? std::span(state.errors.pushes) : std::span<PushNote>(), workers);
     }},
    {"Store",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         StoreImpulses(step, world.bodies, state.solver, world.pairs, world.joints, workers, state.report);
         const bool sweeps = world.bodies.continuousCount > 0;
         if (sweeps) world.seenPoses.Note(world.bodies, workers.jobs);
         world.lock.KeepQueriesOut();
         state.sleepCandidates = MoveBodies(step, world.colliders, world.joints, world.coloring, state.crowd,
                                            world.bodies, state.sweeps, workers, state.report);
         BreakJoints(world.bodies, world.colliders, world.joints, world.coloring, state.events.broken);
         SettleStoppedIn(world, workers);
         if (!sweeps) return;
         world.seenPoses.Show();
         world.lock.LetQueriesIn();
     }},
    {"Continuous",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         Continuous(step, world.pairs, world, state.sweeps, workers, state.report);
         if (world.seenPoses.AreShown()) {
             world.lock.KeepQueriesOut();
             world.seenPoses.Hide();
         }
         EndContinuous(world.bodies, world.colliders, state.sweeps);
         if (step.settings.measuresErrors)
             EndErrors(step, world.bodies, world.joints, world.coloring, state.sweeps, state.errors,
                       state.report.errors);
     }},
    {"Sense",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         Sense(step, world.bodies, world.joints, state.sweeps, world.sensors, world.colliders, state.sensing, workers,
               state.report);
     }},
    {"Events",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         ListContactEvents(step, world.bodies, world.colliders, state.solver, state.sweeps, world.pairs, state.events,
                           workers);
     }},
    {"Sleep",
     [](WorldState& world, StepState& state, const StepContext& step, const StepWorkers& workers) {
         Sleep(step, state.sleepCandidates, world, world.pairs, world.outsideFatBounds, workers.scratch);
         ListBodyEvents(step, world.bodies, state.events, workers);
     }},
};
static_assert(std::size(kStages) == kStageCount, "kStageCount (StepReport.h) is not the number of stages");

using Clock = std::chrono::steady_clock;

double Milliseconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// Frees the bodies that were removed since the last step, and removes all their pairs.
void ForgetRemoved(WorldState& world) {
    if (world.removed.empty() && !world.colliders.movedHasEmpty) return;
    VisitPairsOf(world.bodies, world.colliders, world.pairs, world.removed,
                 [&](uint32_t pair) { RemovePair(world.pairs, world.coloring, pair); });
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

void Clear(EventBuffers& buffers) {
    buffers.contacts.clear();
    buffers.broken.clear();
    for (Array<BodyId>* ids : {&buffers.awake, &buffers.moved, &buffers.woke, &buffers.fellAsleep}) ids->clear();
    buffers.events = {};
}

void BeginReport(WorldState& world, StepState& state) {
    state.report = {};
    state.report.step = ++world.step;
    state.sleepCandidates = 0;
    world.sensors.events.clear();
    Clear(state.events);
    state.sweeps.reported.clear();
    for (WorkerFindings& f : state.findings) {
        f.libccd = {};
        f.clamped = f.frozen = f.sleepCandidates = 0;
        f.deepest = 0;
        f.deepestPair = f.firstFrozen = ~0u;
        f.joints = {};
    }
}

// s: shorter steps are skipped; their motion is below float precision, and their inverse would overflow.
constexpr double kShortestStep = 1e-9;

// Limits of the warm start's scale: impulses of a much shorter step scaled up to a long one are mostly noise, with
// which a swinging chain would tear itself apart. With a limit of two for contacts, too, a stack whose steps alternate
// between 1/240 and 1/30 s would drift by some centimeters, as each long step begins with a quarter of its load.
constexpr float kMostImpulseScale = 2, kMostContactImpulseScale = 8;

// 1/s: rate at which stiffnessDt decreases at most when steps become shorter, by 5 % in 1/60 s.
constexpr float kStiffening = 3.0776f;

StepContext ContextOf(const WorldState& world, const StepState& last, double dt) {
    const float substepDt = static_cast<float>(dt) / static_cast<float>(world.settings.solver.substeps);
    const float longer = last.lastSubstepDt > 0 ? substepDt / last.lastSubstepDt : 1.0f;
    // With the stiffness that short steps allow, bodies that sank during long ones would be thrown apart.
    const float stiffnessDt = std::max(substepDt, Exp(-kStiffening * static_cast<float>(dt)) * last.stiffnessDt);
    return {.settings = world.settings,
            .listener = world.listener,
            .number = world.step,
            .dt = static_cast<float>(dt),
            .substepDt = substepDt,
            .lastSubstepDt = last.lastSubstepDt,
            .impulseScale = std::min(longer, kMostImpulseScale),
            .contactImpulseScale = std::min(longer, kMostContactImpulseScale),
            .stiffnessDt = stiffnessDt,
            .softness = SoftnessOf(world.settings, stiffnessDt)};
}

// Greater effort first; ties by the lower body index.
bool ComesBefore(const IslandEffortReport& a, const IslandEffortReport& b) {
    return std::tie(b.substeps, b.velocityIterations, b.positionIterations, a.culprit.index) <
           std::tie(a.substeps, a.velocityIterations, a.positionIterations, b.culprit.index);
}

void ReportEfforts(const SolverSettings& settings, const BodyStore& bodies, const SolverLayout& layout,
                   StepReport& report) {
    VisitEfforts(settings, bodies, layout, [&](IslandEffortReport effort) {
        ++report.islandsWithMoreEffort;
        for (IslandEffortReport& listed : report.mostEffort)
            if (ComesBefore(effort, listed)) std::swap(effort, listed);
    });
}

void CountBodies(const WorldState& world, const SolverLayout& solver, StepReport& report) {
    report.bodies = world.bodies.Count() - (world.bodies.worldBody != BodyStore::kNone);
    report.awakeBodies = static_cast<uint32_t>(world.bodies.awake.size());
    report.islands = solver.islands;
    report.pairs = static_cast<uint32_t>(world.pairs.active.Size());
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        report.joints += static_cast<uint32_t>(world.coloring.At(c).Of(ConstraintColoring::Kind::Joint).size());
}

// Runs all stages and records their times.
void RunStages(WorldState& world, StepState& state, const StepContext& step) {
    const StepWorkers workers{*world.jobs, state.findings, state.scratch, state.ofWorkers};
    const Clock::time_point start = Clock::now();
    Clock::time_point last = start;
    for (size_t i = 0; i < std::size(kStages); ++i) {
        if (world.observer) world.observer->BeginStage(static_cast<int>(i), kStages[i].name);
        kStages[i].run(world, state, step, workers);
        if (world.observer) world.observer->EndStage(static_cast<int>(i), kStages[i].name);
        const Clock::time_point now = Clock::now();
        state.report.stageMs[i] = Milliseconds(last, now);
        last = now;
    }
    state.report.totalMs = Milliseconds(start, last);
}

}  // namespace

const char* StageName(int stage) { return kStages[stage].name; }

void VisitEfforts(const SolverSettings& settings, const BodyStore& bodies, const SolverLayout& layout,
                  FunctionRef<void(const IslandEffortReport&)> visit) {
    for (const IslandWithEffort& island : layout.efforts) {
        const SolverGroup& group = layout.groups[island.group];
        if (group.effort.Exceeds(settings) || group.isLoaded)
            visit({std::max<int>(group.effort.substeps, settings.substeps),
                   std::max<int>(group.effort.velocityIterations, settings.velocityIterations),
                   std::max<int>(group.effort.positionIterations, settings.positionIterations),
                   bodies.IdOf(island.culprit), island.bodies, group.isLoaded});
    }
}

void RunStep(WorldState& world, StepState& state, double dt) {
    if (dt >= kShortestStep) FollowMovedBodies(world);
    world.coloring.Settle();
    ForgetRemoved(world);
    world.pendingTrees.Suspend();
    BeginReport(world, state);
    if (world.observer) world.observer->BeginStep(world.step);
    if (dt >= kShortestStep) {
        const StepContext step = ContextOf(world, state, dt);
        state.scratch.Reset();
        state.sweeps.isKept = world.bodies.continuousCount > 0 || !world.sensors.IsEmpty();
        state.sweeps.reportsHits = world.settings.events.contacts || world.settings.measuresErrors;
        BeginPushes(world);
        BeginSingleMoves(world.bodies);
        RunStages(world, state, step);
        EndPushes(world.bodies);
        state.events.events.brokenJoints = state.events.broken;
        state.lastSubstepDt = step.substepDt;
        state.stiffnessDt = step.stiffnessDt;
        ReportEfforts(world.settings.solver, world.bodies, state.solver, state.report);
        world.outsideFatBounds.MarkStale();
        for (const WorkerFindings& f : state.findings) state.report.libccd += f.libccd;
    }
    world.pendingTrees.Note();
    CountBodies(world, state.solver, state.report);
    if (world.observer) world.observer->EndStep(world.step);
}

}  // namespace fulcrum
