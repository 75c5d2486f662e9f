#include <Fulcrum/Samples/Runner/Simulation.h>

#include <Fulcrum/Samples/Scenes/SpringEnergy.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

namespace fulcrum {
namespace {

std::string BodyText(const SceneWorld& world, BodyId id) {
    const ShapePtr shape = world.Bodies().GetShape(id);
    return (shape ? std::string(ShapeTypeName(shape->Type())) + " " : std::string()) + std::to_string(id.index);
}

void NotePenetration(const SceneWorld& world, RunFigures& figures) {
    const StepReport& report = world.System().Report();
    if (report.largestPenetration <= figures.largestPenetration) return;
    figures.largestPenetration = report.largestPenetration;
    figures.deepestPair = BodyText(world, report.deepestA) + " and " + BodyText(world, report.deepestB);
    figures.deepestStep = world.StepCount();
}

void NoteErrors(const SceneWorld& world, ErrorFigures& figures) {
    const StepReport& report = world.System().Report();
    const StepErrors& errors = report.errors;
    const auto note = [&](WorstOfRun& worst, double value, auto&& whose) {
        if (!(value > worst.value)) return;
        worst = {value, whose(), world.StepCount()};
    };
    const auto body = [&](BodyId id) { return [&world, id] { return BodyText(world, id); }; };
    const auto joint = [&](JointId id) { return [id] { return "joint " + std::to_string(id.index); }; };
    note(figures.jointError, double{report.largestJointError}, joint(report.worstJoint));
    note(figures.jointAngle, double{report.largestJointAngle}, joint(report.mostTurnedJoint));
    note(figures.energyGain, errors.energyGain, body(errors.mostGaining));
    note(figures.momentum, errors.momentumError, body(errors.momentumBody));
    note(figures.angularMomentum, errors.angularMomentumError, body(errors.angularMomentumBody));
    note(figures.push, errors.largestPushEnergy, body(errors.mostPushed));
    const IslandEffortReport& effort = report.mostEffort[0];
    note(figures.effort, effort.substeps, body(effort.culprit));
    figures.solvesDirectly |= std::ranges::any_of(report.mostEffort, &IslandEffortReport::isDirect);
    figures.energyChange += errors.energyChange;
}

void CountBodies(const SceneWorld& world, RunFigures& figures) {
    world.System().VisitBodies([&](BodyId id) {
        ++figures.bodies;
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic) ++figures.dynamicBodies;
    });
    std::vector<bool> awake;  // by island
    world.System().VisitIslands([&](BodyId id, uint32_t island) {
        if (awake.size() <= island) awake.resize(island + 1);
        if (world.Bodies().IsAwake(id)) awake[island] = true;
    });
    figures.islands = static_cast<uint32_t>(awake.size());
    figures.awakeIslands = static_cast<uint32_t>(std::count(awake.begin(), awake.end(), true));
}

// Wall clock of five calls, after one that is not timed.
Statistics TimeFiveTimes(SceneWorld& world, void (*query)(SceneWorld& world)) {
    constexpr int kTimes = 5;
    std::vector<double> ms;
    for (int i = 0; i <= kTimes; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        query(world);
        const auto end = std::chrono::steady_clock::now();
        if (i > 0) ms.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
    }
    return Summarize(std::move(ms));
}

void TimeQueries(SceneWorld& world, RunFigures& figures) {
    const Scene& scene = world.Definition();
    if (!scene.query) return;
    figures.queryCount = scene.queryCount;
    figures.queryName = scene.queryName;
    figures.queryMs = TimeFiveTimes(world, scene.query);
    if (scene.querySingly)
        figures.singleQueryNs = 1e6 * TimeFiveTimes(world, scene.querySingly).median / scene.queryCount;
}

// The meters of Scenes/RestMeters.h over a run.
class RestFigures {
public:
    RestFigures(const SceneWorld& world, int steps, double dt)
        : system_(world.System()), dt_(dt), stepsBeforeTheLastSecond_(std::max(0, steps - StepsIn(1, dt))) {
        if (world.Definition().isBuiltToStand) drift_.emplace(system_);
        if (world.Definition().isClosed) energy_.emplace(system_);
        if (system_.Settings().sleep.enabled) sleep_ = SleepTime{{}, steps * dt};
        BeforeStep(0);
    }
    // When `done` steps are.
    void AfterStep(int done) {
        if (speed_) speed_->Measure(dt_);
        if (energy_) energy_->Measure();
        if (sleep_ && !sleep_->seconds && AllAsleep(system_)) sleep_->seconds = done * dt_;
        BeforeStep(done);
    }
    void Fill(RunFigures& figures) const {
        if (drift_) figures.drift = drift_->Measure();
        if (speed_) figures.endSpeed = speed_->Largest();
        if (energy_) figures.energyRise = EnergyRise{energy_->Rise(), energy_->RelativeRise()};
        figures.sleep = sleep_;
    }

private:
    void BeforeStep(int done) {
        if (done == stepsBeforeTheLastSecond_) speed_.emplace(system_);
    }

    const PhysicsSystem& system_;
    double dt_;
    int stepsBeforeTheLastSecond_;
    std::optional<DriftMeter> drift_;
    std::optional<SpeedMeter> speed_;
    std::optional<EnergyMeter> energy_;
    std::optional<SleepTime> sleep_;
};

}  // namespace

double QueriesPerSecond(const RunFigures& figures) {
    return figures.queryMs.median > 0 ? 1000 * figures.queryCount / figures.queryMs.median : 0;
}

Statistics Summarize(std::vector<double> samples) {
    Statistics result;
    if (samples.empty()) return result;
    for (double sample : samples) result.mean += sample;
    std::sort(samples.begin(), samples.end());
    const size_t count = samples.size();
    result.mean /= static_cast<double>(count);
    result.median = count % 2 == 1 ? samples[count / 2] : 0.5 * (samples[count / 2 - 1] + samples[count / 2]);
    result.p99 = samples[(99 * count + 99) / 100 - 1];
    result.max = samples.back();
    return result;
}

Result<RunFigures> Simulate(SceneWorld& world, int untimed, int steps, double dt, uint32_t threads,
                            FunctionRef<void()> afterStep, RestMeters restMeters) {
    RunFigures figures;
    figures.steps = steps;
    figures.dt = dt;
    figures.threads = threads;
    figures.solver = world.System().Settings().solver;
    figures.narrowPhase = world.System().Settings().narrowPhase;
    figures.energyAtStart = TotalEnergy(world.System());

    if (world.System().Settings().measuresErrors) figures.errors.emplace();
    PenetrationMeter meter(world);
    std::optional<RestFigures> rest;
    if (restMeters == RestMeters::On) rest.emplace(world, untimed + steps, dt);
    std::vector<double> stepMs;
    std::array<std::vector<double>, kStageCount> stageMs;
    for (int step = 0; step < untimed + steps; ++step) {
        const Status status = world.Step(dt);
        if (!status) return status.GetError();
        const StepReport& report = world.System().Report();
        if (step >= untimed) {
            stepMs.push_back(world.LastStepMs());
            for (size_t stage = 0; stage < stageMs.size(); ++stage) stageMs[stage].push_back(report.stageMs[stage]);
        }
        NotePenetration(world, figures);
        if (figures.errors) NoteErrors(world, *figures.errors);
        if (rest) rest->AfterStep(step + 1);
        if (meter.Measure())
            figures.overlapPair = BodyText(world, meter.Worst().bodyA) + " and " + BodyText(world, meter.Worst().bodyB);
        figures.largestContacts = std::max(figures.largestContacts, report.contacts);
        figures.libccdFailures += report.libccd.epaFailures;
        figures.libccdFallbacks += report.libccd.centerLineFallbacks;
        afterStep();
    }

    figures.stepMs = Summarize(std::move(stepMs));
    for (size_t stage = 0; stage < stageMs.size(); ++stage)
        figures.stageMedianMs[stage] = Summarize(std::move(stageMs[stage])).median;
    figures.overlap = meter.Worst();
    if (rest) rest->Fill(figures);
    TimeQueries(world, figures);
    figures.last = world.System().Report();
    CountBodies(world, figures);
    figures.energyAtEnd = TotalEnergy(world.System());
    figures.poseHash = world.System().HashPoses();
    figures.memoryBytes = world.System().MemoryUsed();
    figures.accuracy = world.Definition().accuracy ? world.Definition().accuracy(world) : 0;
    figures.nonFinite = world.NonFiniteBodies();
    return figures;
}

Status MeasureRest(const Scene& scene, const SceneInput& input, JobSystem* jobs, int steps, double dt,
                   RunFigures& figures) {
    const auto world = SceneWorld::Create(scene, input, jobs);
    if (!world) return world.GetError();
    RestFigures rest(*world.Value(), steps, dt);
    for (int step = 1; step <= steps; ++step) {
        const Status status = world.Value()->Step(dt);
        if (!status) return status;
        rest.AfterStep(step);
    }
    rest.Fill(figures);
    return Done{};
}

Result<SleepTime> MeasureSleep(const Scene& scene, SceneInput input, JobSystem* jobs, double dt, double limit) {
    input.sleeping = true;
    const auto world = SceneWorld::Create(scene, input, jobs);
    if (!world) return world.GetError();
    const Result<std::optional<double>> seconds = TimeToSleep(*world.Value(), dt, limit);
    if (!seconds) return seconds.GetError();
    return SleepTime{seconds.Value(), limit};
}

Result<std::vector<double>> AccuracyOfRuns(const Scene& scene, const SceneInput& input, JobSystem* jobs, int steps,
                                           double dt) {
    std::vector<double> accuracies;
    for (int run = 0; run < scene.accuracyRuns; ++run) {
        SceneInput changed = input;
        changed.gravityScale *= 1 + 1e-6 * run;
        const auto world = SceneWorld::Create(scene, changed, jobs);
        if (!world) return world.GetError();
        for (int step = 0; step < steps; ++step) {
            const Status status = world.Value()->Step(dt);
            if (!status) return status.GetError();
        }
        if (scene.query) scene.query(*world.Value());
        accuracies.push_back(scene.accuracy(*world.Value()));
    }
    return accuracies;
}

std::string HashText(uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

}  // namespace fulcrum
