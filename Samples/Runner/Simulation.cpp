#include <Fulcrum/Samples/Runner/Simulation.h>

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

void TimeQueries(SceneWorld& world, RunFigures& figures) {
    const Scene& scene = world.Definition();
    if (!scene.query) return;
    constexpr int kTimes = 5;
    std::vector<double> ms;
    for (int i = 0; i <= kTimes; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        scene.query(world);
        const auto end = std::chrono::steady_clock::now();
        if (i > 0) ms.push_back(std::chrono::duration<double, std::milli>(end - begin).count());
    }
    figures.queryCount = scene.queryCount;
    figures.queryName = scene.queryName;
    figures.queryMs = Summarize(std::move(ms));
}

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
                            FunctionRef<void()> afterStep) {
    RunFigures figures;
    figures.steps = steps;
    figures.dt = dt;
    figures.threads = threads;
    figures.solver = world.System().Settings().solver;
    figures.narrowPhase = world.System().Settings().narrowPhase;
    figures.energyAtStart = world.System().GetEnergy();

    PenetrationMeter meter(world);
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
    TimeQueries(world, figures);
    figures.last = world.System().Report();
    CountBodies(world, figures);
    figures.energyAtEnd = world.System().GetEnergy();
    figures.poseHash = world.System().HashPoses();
    figures.memoryBytes = world.System().MemoryUsed();
    figures.accuracy = world.Definition().accuracy ? world.Definition().accuracy(world) : 0;
    figures.nonFinite = world.NonFiniteBodies();
    return figures;
}

std::string HashText(uint64_t hash) {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

}  // namespace fulcrum
