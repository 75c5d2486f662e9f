#include <Fulcrum/PerformanceTest/Scenes/Bench.h>

#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Samples/Runner/CommandLine.h>
#include <Fulcrum/Samples/Runner/JsonOutput.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Runner/RunReport.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <nlohmann/json.hpp>

#include <cstdio>
#include <optional>

namespace fulcrum {
namespace {

int Fail(const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s\n", message.c_str());
    return 1;
}

std::vector<const Scene*> PerformanceScenes() {
    std::vector<const Scene*> scenes;
    for (const Scene* scene : AllScenes())
        if (scene->kind == SceneKind::Performance) scenes.push_back(scene);
    return scenes;
}

void PrintHeading() {
    std::printf("%-16s %3s %7s %8s %5s  %9s %9s %9s %9s %9s  %11s  %7s  %8s  %s\n", "scene", "thr", "bodies",
                "contacts", "steps", "median ms", "mean ms", "p99 ms", "max ms", "steps/s", "accuracy", "overlap",
                "memory", "hash");
}

void PrintRow(const Scene& scene, const RunFigures& run) {
    const Statistics& ms = ComparedMs(run);
    std::printf("%-16s %3u %7zu %8u %5d  %9.4f %9.4f %9.4f %9.4f %9.1f  %11.5g  %7.4f  %5.0f MB  %s\n", scene.name,
                run.threads, run.bodies, run.last.contacts, run.steps, ms.median, ms.mean, ms.p99, ms.max,
                1000 / run.stepMs.mean, run.accuracy, run.overlap.relative, static_cast<double>(run.memoryBytes) / 1e6,
                HashText(run.poseHash).c_str());
    if (run.queryCount > 0)
        std::printf("%20s %d %s a batch, which the ms are of: %.4g %s/s\n", "", run.queryCount, run.queryName.c_str(),
                    QueriesPerSecond(run), run.queryName.c_str());
    std::fflush(stdout);
}

}  // namespace

Result<BenchOptions> ParseBenchOptions(std::vector<std::string> arguments) {
    BenchOptions options;
    std::string name = "all";
    CLI::App app("Times the performance scenes: 1 untimed step, then each step by itself", "./fulcrum bench");
    AddText(app, "--scene", "a scene's name, or all the performance scenes (default all)",
            [&](const std::string& text) { name = text; })
        ->type_name("SCENE");
    AddInteger(app, "--threads", 1, kMostThreads, "threads (default 1)", [&](int value) { options.threads = value; });
    AddInteger(app, "--steps", 1, kMostSteps, "timed steps (default: the scene's own number)",
               [&](int value) { options.steps = value; });
    AddInteger(app, "--runs", 1, 1000, "runs of each scene; the one with the lowest median counts (default 1)",
               [&](int value) { options.runs = value; });
    AddSolverOptions(app, options.solver);
    AddNarrowPhaseOption(app, options.narrowPhase);
    AddSeed(app, "--seed", "of scenes that use random numbers (default 1)",
            [&](uint64_t value) { options.seed = value; });
    AddText(app, "--json", "also write the runs as a JSON array; -: to standard output, all else to standard error",
            [&](const std::string& text) { options.json = text; })
        ->type_name("FILE");

    Result<std::string> parsed = ParseCommandLine(app, std::move(arguments));
    if (!parsed) return parsed.GetError();
    options.help = parsed.Value();
    if (const Scene* scene = FindScene(name)) {
        options.scenes = {scene};
    } else if (name == "all") {
        options.scenes = PerformanceScenes();
    } else {
        std::vector<std::string> names = SceneNames();
        names.push_back("all");
        return UnknownName("scene", name, names);
    }
    return options;
}

Result<RunFigures> TimeScene(const Scene& scene, const BenchOptions& options) {
    SceneInput input;
    input.seed = options.seed;
    input.solver = options.solver;
    input.narrowPhase = options.narrowPhase;
    std::optional<ThreadPool> pool;
    if (options.threads > 1) pool.emplace(static_cast<uint32_t>(options.threads));
    const auto world = SceneWorld::Create(scene, input, pool ? &*pool : nullptr);
    if (!world) return world.GetError();
    const int steps = options.steps > 0 ? options.steps : scene.steps;
    // A batch is timed after exactly that many steps.
    const int untimed = scene.query ? 0 : 1;
    return Simulate(*world.Value(), untimed, steps, 1.0 / 60, pool ? pool->WorkerCount() : 1, [] {});
}

int RunBench(const BenchOptions& options) {
    const JsonOutput json(options.json);
    const std::string trouble = json.Check();
    if (!trouble.empty()) return Fail(trouble);

    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    PrintHeading();
    for (const Scene* scene : options.scenes) {
        std::optional<RunFigures> best;
        for (int i = 0; i < options.runs; ++i) {
            Result<RunFigures> run = TimeScene(*scene, options);
            if (!run) return Fail(std::string(scene->name) + ": " + run.GetError().message);
            if (!best || ComparedMs(run.Value()).median < ComparedMs(*best).median) best = run.Value();
        }
        PrintRow(*scene, *best);
        rows.push_back(ReportJson(scene->name, *best, options.seed));
    }
    const std::string unwritten = json.IsWanted() ? json.Write(rows) : "";
    return unwritten.empty() ? 0 : Fail(unwritten);
}

}  // namespace fulcrum
