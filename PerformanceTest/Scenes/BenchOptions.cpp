#include <Fulcrum/PerformanceTest/Scenes/BenchOptions.h>

#include <Fulcrum/PerformanceTest/Peers/Peer.h>
#include <Fulcrum/PerformanceTest/Scenes/Comparison.h>
#include <Fulcrum/Samples/Runner/CommandLine.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <algorithm>
#include <charconv>

namespace fulcrum {
namespace {

constexpr int kComparedRuns = 7;

MaybeError FindScenes(const std::vector<std::string>& names, std::vector<const Scene*>& scenes) {
    const auto add = [&](const Scene* scene) {
        if (std::find(scenes.begin(), scenes.end(), scene) == scenes.end()) scenes.push_back(scene);
    };
    for (const std::string& name : names) {
        const Scene* found = FindScene(name);
        if (!found && name != "all") {
            std::vector<std::string> known = SceneNames();
            known.push_back("all");
            return UnknownName("scene", name, known);
        }
        if (found) add(found);
        else
            for (const Scene* scene : AllScenes())
                if (scene->kind == SceneKind::Performance) add(scene);
    }
    return std::nullopt;
}

// "10%" or "10": per cent.
double ParseTolerance(std::string text) {
    const std::string given = text;
    if (!text.empty() && text.back() == '%') text.pop_back();
    double value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || !(value >= 0 && value <= 1000))
        throw CLI::ValidationError("--tolerance takes per cent from 0 to 1000, as in 10%, not '" + given + "'");
    return value / 100;
}

void AddTimeOptions(CLI::App& app, BenchOptions& options, std::vector<std::string>& scenes, int& runs) {
    app.add_option_function<std::vector<std::string>>(
           "--scene,SCENE", [&](const std::vector<std::string>& names) { scenes = names; },
           "scenes, or all the performance scenes (default all)")
        ->type_name("SCENE...");
    AddIntegers(app, "--threads", 1, kMostThreads, "threads, or several numbers of them: 1,2 (default 1)",
                [&](const std::vector<int>& values) { options.threads = values; });
    AddInteger(app, "--steps", 1, kMostSteps, "timed steps (default: the scene's own number)",
               [&](int value) { options.steps = value; });
    AddReal(app, "--dt", 1e-5, 1, "seconds a step (default 1/60)", [&](double value) { options.dt = value; });
    AddInteger(app, "--runs", 1, 1000,
               "rounds over the scenes; of each scene the run with the lowest median is shown (default 1, with --save "
               "and --baseline 7, 5 at least)",
               [&](int value) { runs = value; });
    app.add_flag_function(
        "--only-timed", [&](int64_t) { options.accuracyRuns = false; },
        "only the timed runs, none for drift, speed, sleep, energy and accuracy figures that are medians; so does "
        "--steps");
    AddSolverOptions(app, options.solver);
    AddNarrowPhaseOption(app, options.narrowPhase);
    AddSeed(app, "--seed", "of scenes that use random numbers (default 1)",
            [&](uint64_t value) { options.seed = value; });
}

void AddOutputOptions(CLI::App& app, BenchOptions& options) {
    AddText(app, "--json", "also write the runs as JSON; -: to standard output, all else to standard error",
            [&](const std::string& text) { options.json = text; })
        ->type_name("FILE");
    AddText(app, "--save", "write what --baseline takes: the same JSON", [&](const std::string& text) {
        options.save = text;
    })->type_name("FILE");
    CLI::Option* baseline = AddText(app, "--baseline",
                                    "compare with the runs of this file, by default with all of them; exit status 1 "
                                    "where a scene is slower or less accurate",
                                    [&](const std::string& text) { options.baseline = text; })
                                ->type_name("FILE");
    AddText(app, "--tolerance", "by how much a scene may be slower than in the baseline (default 10%)",
            [&](const std::string& text) { options.tolerance = ParseTolerance(text); })
        ->type_name("PERCENT")
        ->needs(baseline);
    app.add_option_function<std::vector<std::string>>(
           "--history", [&](const std::vector<std::string>& files) { options.history = files; },
           "time nothing, print the runs of these files over time; --scene chooses some")
        ->type_name("FILE...");
    AddText(app, "--peer", "also run the scenes in another engine, with one thread: bullet",
            [&](const std::string& name) {
                const Result<const Peer*> peer = FindPeer(name, "bench");
                if (!peer) throw CLI::ValidationError(peer.GetError().message);
                options.peer = peer.Value();
            })
        ->type_name("ENGINE");
    app.add_flag_function(
        "--quiet", [&](int64_t) { options.quiet = true; }, "print only what is slower or less accurate, and errors");
}

}  // namespace

Result<BenchOptions> ParseBenchOptions(std::vector<std::string> arguments) {
    BenchOptions options;
    std::vector<std::string> scenes;
    int runs = 0;
    CLI::App app("Times the performance scenes: 1 untimed step, then each step by itself", "./fulcrum bench");
    AddTimeOptions(app, options, scenes, runs);
    AddOutputOptions(app, options);

    Result<std::string> parsed = ParseCommandLine(app, std::move(arguments));
    if (!parsed) return parsed.GetError();
    options.help = parsed.Value();
    if (MaybeError error = FindScenes(scenes, options.scenes)) return *error;
    if (options.steps > 0) options.accuracyRuns = false;
    const bool isCompared = !options.save.empty() || !options.baseline.empty();
    if (isCompared && runs > 0 && runs < kFewestComparedRuns)
        return Error{ErrorCode::OutOfRange, "--runs " + std::to_string(runs) +
                                                " is too few to compare; the nearest valid value is " +
                                                std::to_string(kFewestComparedRuns)};
    options.runs = runs > 0 ? runs : isCompared ? kComparedRuns : 1;
    return options;
}

}  // namespace fulcrum
