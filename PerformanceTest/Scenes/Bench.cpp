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
    if (run.singleQueryNs > 0) std::printf("%20s %.4g ns for one by a call of its own\n", "", run.singleQueryNs);
    std::fflush(stdout);
}

struct Row {
    const Scene& scene;
    RunFigures run;
};

std::string Number(const char* format, std::optional<double> value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof text, format, *value);
    return text;
}

std::string SleepText(const std::optional<SleepTime>& sleep) {
    if (!sleep) return "-";
    return sleep->seconds ? Number("%.2f", *sleep->seconds) : "never";
}

void PrintAccuracy(const std::vector<Row>& rows) {
    std::printf("\n%-16s %11s  %7s  %10s %10s  %10s  %8s  %11s %9s\n", "scene", "accuracy", "overlap", "drift mm",
                "mean mm", "end m/s", "asleep s", "rise J", "rise");
    for (const Row& row : rows) {
        const RunFigures& run = row.run;
        std::optional<double> largest, mean, joules, relative;
        if (run.drift) {
            largest = 1000 * run.drift->largest;
            mean = 1000 * run.drift->mean;
        }
        if (run.energyRise) {
            joules = run.energyRise->joules;
            relative = run.energyRise->relative;
        }
        std::printf("%-16s %11.5g  %7.4f  %10s %10s  %10s  %8s  %11s %9s\n", row.scene.name, run.accuracy,
                    run.overlap.relative, Number("%.4g", largest).c_str(), Number("%.4g", mean).c_str(),
                    Number("%.5g", run.endSpeed).c_str(), SleepText(run.sleep).c_str(), Number("%.4g", joules).c_str(),
                    Number("%.2g", relative).c_str());
    }
    std::printf(
        "accuracy: see ./fulcrum run; drift: sideways from where bodies were built, the largest and the mean;\n"
        "end: the largest speed in the last second; rise: of kinetic plus potential energy, also over that at "
        "the start\n");
}

SceneInput InputOf(const BenchOptions& options) {
    SceneInput input;
    input.seed = options.seed;
    input.solver = options.solver;
    input.narrowPhase = options.narrowPhase;
    return input;
}

constexpr double kStep = 1.0 / 60, kSleepLimit = 20;  // s

// A scene that is timed, with the threads that the options ask for.
class Timed {
public:
    Timed(const Scene& scene, const BenchOptions& options) : scene_(scene), input_(InputOf(options)) {
        if (options.threads > 1) pool_.emplace(static_cast<uint32_t>(options.threads));
        steps_ = options.steps > 0 ? options.steps : scene.steps;
    }

    Result<RunFigures> Run() {
        const auto world = SceneWorld::Create(scene_, input_, Jobs());
        if (!world) return world.GetError();
        return Simulate(
            *world.Value(), UntimedSteps(), steps_, kStep, pool_ ? pool_->WorkerCount() : 1, [] {}, RestMeters::Off);
    }
    // Fills in what needs runs of its own.
    Status AddAccuracyRuns(RunFigures& figures) {
        const int steps = UntimedSteps() + steps_;
        const Status rest = MeasureRest(scene_, input_, Jobs(), steps, kStep, figures);
        if (!rest) return rest;
        if (scene_.isClosed) {  // what is driven does not sleep
            const Result<SleepTime> sleep = MeasureSleep(scene_, input_, Jobs(), kStep, kSleepLimit);
            if (!sleep) return sleep.GetError();
            figures.sleep = sleep.Value();
        }
        if (scene_.accuracyRuns <= 1) return Done{};
        Result<std::vector<double>> runs = AccuracyOfRuns(scene_, input_, Jobs(), steps, kStep);
        if (!runs) return runs.GetError();
        figures.accuracies = std::move(runs.Value());
        figures.accuracy = Summarize(figures.accuracies).median;
        return Done{};
    }

private:
    JobSystem* Jobs() { return pool_ ? &*pool_ : nullptr; }
    // A batch is timed after exactly the scene's steps.
    int UntimedSteps() const { return scene_.query ? 0 : 1; }

    const Scene& scene_;
    SceneInput input_;
    std::optional<ThreadPool> pool_;
    int steps_;
};

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
    app.add_flag_function(
        "--only-timed", [&](int64_t) { options.accuracyRuns = false; },
        "only the timed runs, none for drift, speed, sleep, energy and accuracy figures that are medians; so does "
        "--steps");
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
    if (options.steps > 0) options.accuracyRuns = false;
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
    Timed timed(scene, options);
    std::optional<RunFigures> best;
    for (int i = 0; i < options.runs; ++i) {
        Result<RunFigures> run = timed.Run();
        if (!run) return run;
        if (!best || ComparedMs(run.Value()).median < ComparedMs(*best).median) best = std::move(run.Value());
    }
    if (options.accuracyRuns) {
        const Status status = timed.AddAccuracyRuns(*best);
        if (!status) return status.GetError();
    }
    return std::move(*best);
}

int RunBench(const BenchOptions& options) {
    const JsonOutput json(options.json);
    const std::string trouble = json.Check();
    if (!trouble.empty()) return Fail(trouble);

    nlohmann::ordered_json array = nlohmann::ordered_json::array();
    std::vector<Row> rows;
    PrintHeading();
    for (const Scene* scene : options.scenes) {
        Result<RunFigures> run = TimeScene(*scene, options);
        if (!run) return Fail(std::string(scene->name) + ": " + run.GetError().message);
        PrintRow(*scene, run.Value());
        array.push_back(ReportJson(scene->name, run.Value(), options.seed));
        rows.push_back({*scene, std::move(run.Value())});
    }
    if (options.accuracyRuns) PrintAccuracy(rows);
    const std::string unwritten = json.IsWanted() ? json.Write(array) : "";
    return unwritten.empty() ? 0 : Fail(unwritten);
}

}  // namespace fulcrum
