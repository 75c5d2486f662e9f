#include <Fulcrum/Samples/Runner/Options.h>

#include <Fulcrum/Samples/Runner/CommandLine.h>
#include <Fulcrum/Samples/Runner/FileScene.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <thread>

namespace fulcrum {
namespace {

void SetRecord(const std::string& text, RunOptions& options) {
    options.recordHtml = options.recordGlb = false;
    const std::array<std::string, 3> kinds{"html", "glb", "none"};
    bool none = false;
    std::istringstream list(text);
    for (std::string kind; std::getline(list, kind, ',');) {
        if (kind.empty()) continue;
        if (kind == "html") options.recordHtml = true;
        else if (kind == "glb") options.recordGlb = true;
        else if (kind == "none") none = true;
        else throw CLI::ValidationError(UnknownName("kind of --record", kind, kinds).message);
    }
    if (none && (options.recordHtml || options.recordGlb))
        throw CLI::ValidationError("--record " + text + ": none stands alone; html,glb records both");
    if (!none && !options.recordHtml && !options.recordGlb)
        throw CLI::ValidationError("--record takes html, glb, html,glb or none");
}

// The enumerator whose name, in the order of their values, the text is.
template <class E, size_t N>
E ParseEnumerator(const char* what, const std::string& text, const std::array<std::string, N>& names) {
    for (size_t i = 0; i < N; ++i)
        if (text == names[i]) return static_cast<E>(i);
    throw CLI::ValidationError(UnknownName(what, text, names).message);
}

PositionCorrection ParsePositionCorrection(const std::string& text) {
    return ParseEnumerator<PositionCorrection, 2>(
        "kind of --position-correction", text,
        {PositionCorrectionName(PositionCorrection::SoftRelax), PositionCorrectionName(PositionCorrection::Baumgarte)});
}

SolverSettings ParsePreset(const std::string& text) {
    enum class Preset : uint8_t { Fast, Balanced, Accurate, Reference };
    switch (ParseEnumerator<Preset, 4>("--preset", text, {"fast", "balanced", "accurate", "reference"})) {
        case Preset::Fast: return SolverSettings::Fast();
        case Preset::Balanced: return SolverSettings::Balanced();
        case Preset::Accurate: return SolverSettings::Accurate();
        case Preset::Reference: return SolverSettings::Reference();
    }
    return {};
}

UpAxis ParseUpAxis(const std::string& text) {
    return ParseEnumerator<UpAxis, 6>("axis of --onto-up", text, {"x", "y", "z", "-x", "-y", "-z"});
}

NarrowPhaseMethod ParseNarrowPhase(const std::string& text) {
    for (const NarrowPhaseMethod method : {NarrowPhaseMethod::Automatic, NarrowPhaseMethod::Libccd})
        if (text == NarrowPhaseName(method)) return method;
    throw CLI::ValidationError("--narrow-phase takes automatic or libccd, not '" + text + "'");
}

void AddOntoOptions(CLI::App& app, Command& command) {
    CLI::Option* onto =
        AddText(app, "--onto", "drop them onto the triangles of this mesh, made 20 m large, not onto a floor",
                [&](const std::string& text) { command.onto = text; })
            ->type_name("FILE");
    AddReal(app, "--onto-scale", 1e-6, 1e6, "meters a unit of that file, instead of 20 m in all", [&](double value) {
        command.ontoSettings.scale = value;
    })->needs(onto);
    AddText(app, "--onto-up", "which way is up in that file: x, y (default), z, -x, -y or -z",
            [&](const std::string& text) { command.ontoSettings.up = ParseUpAxis(text); })
        ->type_name("AXIS")
        ->needs(onto);
}

void AddThreads(CLI::App& app, RunOptions& options) {
    AddInteger(app, "--threads", 1, kMostThreads, "threads (default: all of this machine)",
               [&](int value) { options.threads = value; });
}

void AddRunOptions(CLI::App& app, RunOptions& options) {
    CLI::Option* steps =
        AddInteger(app, "--steps", 1, kMostSteps, "steps to simulate (default: the scene's own number)",
                   [&](int value) { options.steps = value; });
    AddReal(app, "--seconds", 0.001, 1e6, "simulated time instead of --steps", [&](double value) {
        options.seconds = value;
    })->excludes(steps);
    AddReal(app, "--dt", 1e-5, 1, "seconds a step (default 1/60, or that of the file)",
            [&](double value) { options.givenDt = options.dt = value; });
    AddThreads(app, options);
    AddSolverOptions(app, options.solver);
    AddNarrowPhaseOption(app, options.narrowPhase);
    app.add_flag("--errors", options.errors,
                 "also measure and report what steps make of energy and momentum, gaps, pushes, efforts");
    AddText(app, "--record", "html,glb (default), html, glb or none", [&](const std::string& text) {
        SetRecord(text, options);
    })->type_name("KINDS");
    AddText(app, "--json", "also write the report as JSON; -: to standard output, all else to standard error",
            [&](const std::string& text) { options.json = text; })
        ->type_name("FILE");
    AddText(app, "--calls", "also record the calls, for ./fulcrum replay and shrink", [&](const std::string& text) {
        options.calls = text;
    })->type_name("FILE");
    AddText(app, "--out", "folder of what is recorded (default: out)", [&](const std::string& text) {
        options.out = text;
    })->type_name("DIR");
    app.add_flag("--quiet", options.isQuiet, "say nothing but what goes wrong; the exit status says the rest");
    AddSeed(app, "--seed", "of the random numbers of scenes that use them (default 1)",
            [&](uint64_t value) { options.seed = value; });
}

void AddShrinkOptions(CLI::App& app, ShrinkOptions& options) {
    CLI::Option* speed = AddReal(app, "--speed", 0, 1e9, "it fails if a body is faster than this, m/s",
                                 [&](double value) { options.speed = value; });
    CLI::Option* below = AddReal(app, "--below", -1e9, 1e9, "it fails if a dynamic body is below this height, m",
                                 [&](double value) { options.below = value; });
    CLI::Option* differs =
        app.add_flag("--differs", options.differs, "it fails if one thread and several give different bits");
    CLI::Option* crashes = app.add_flag("--crashes", options.crashes, "it fails if the program dies; with one thread");
    speed->excludes(below)->excludes(differs)->excludes(crashes);
    below->excludes(differs)->excludes(crashes);
    differs->excludes(crashes);
    AddText(app, "--out", "the smaller recording (default: FILE with .small before its ending)",
            [&](const std::string& text) { options.out = text; })
        ->type_name("FILE");
}

// An error that names what was probably meant.
MaybeError FindNamed(const std::string& name, const Scene*& scene) {
    scene = FindScene(name);
    if (scene) return {};
    Error error = UnknownName("scene", name, SceneNames());
    error.message += " (./fulcrum list shows all)";
    return error;
}

}  // namespace

int RunOptions::StepsOf(const Scene& scene) const {
    if (steps) return *steps;
    // A millionth of a step is rounding: 5 s of 1/60 s are 300 steps.
    const double exact = (seconds ? *seconds : scene.steps / 60.0) / dt;
    return static_cast<int>(std::clamp(std::ceil(exact - 1e-6 * std::max(1.0, exact)), 1.0, 1.0 * kMostSteps));
}

void AddSolverOptions(CLI::App& app, SolverSettings& solver) {
    AddText(app, "--preset", "fast, balanced (default), accurate or reference; the numbers below come on top",
            [&](const std::string& name) { solver = ParsePreset(name); })
        ->type_name("PRESET");
    const auto text = [](const char* what, int value) {
        return std::string(what) + " (default " + std::to_string(value) + ")";
    };
    AddInteger(app, "--substeps", 1, 255, text("solver substeps a step", solver.substeps),
               [&](int value) { solver.substeps = value; });
    AddInteger(app, "--velocity-iterations", 1, 255, text("velocity iterations a substep", solver.velocityIterations),
               [&](int value) { solver.velocityIterations = value; });
    AddInteger(app, "--position-iterations", 0, 255, text("position iterations a substep", solver.positionIterations),
               [&](int value) { solver.positionIterations = value; });
    AddText(app, "--position-correction", "soft (default): soft rows and relaxing passes; baumgarte: position passes",
            [&](const std::string& kind) { solver.positionCorrection = ParsePositionCorrection(kind); })
        ->type_name("KIND");
}

void AddNarrowPhaseOption(CLI::App& app, NarrowPhaseMethod& method) {
    AddText(app, "--narrow-phase", "automatic (default), or libccd: shapes collide by libccd, slower, to compare",
            [&](const std::string& text) { method = ParseNarrowPhase(text); })
        ->type_name("METHOD");
}

const char* PositionCorrectionName(PositionCorrection correction) {
    return correction == PositionCorrection::Baumgarte ? "baumgarte" : "soft";
}

const char* NarrowPhaseName(NarrowPhaseMethod method) {
    return method == NarrowPhaseMethod::Libccd ? "libccd" : "automatic";
}

std::vector<std::string> SceneNames() {
    std::vector<std::string> names;
    for (const Scene* scene : AllScenes()) names.push_back(scene->name);
    return names;
}

Result<Command> ParseRunnerCommand(std::vector<std::string> arguments) {
    Command command;
    command.options.threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, kMostThreads);
    std::string sceneName, file;

    CLI::App app("Simulates scenes of Fulcrum", "fulcrum");
    CLI::App* run =
        app.add_subcommand("run", "simulate a scene, report, record it to out/SCENE.html and out/SCENE.glb");
    run->add_option("scene", sceneName, "one of ./fulcrum list, or a scene file: FILE.json or FILE.cbor")
        ->type_name("SCENE");
    AddRunOptions(*run, command.options);
    CLI::App* exported = app.add_subcommand("export", "write a scene to a file that run takes and you may edit");
    exported->add_option("scene", sceneName, "one of ./fulcrum list")->type_name("SCENE");
    exported->add_option("file", file, "FILE.json, or FILE.cbor, which is smaller")->type_name("FILE");
    CLI::App* drop = app.add_subcommand("drop", "the same with a heap of the mesh in a file: OBJ, STL, PLY, glTF, ...");
    drop->add_option("file", file, "the mesh; each of its parts becomes a convex hull, the whole 1 m large")
        ->type_name("FILE");
    AddInteger(*drop, "--count", 1, 20'000, "bodies in the heap (default 50)",
               [&](int value) { command.count = value; });
    AddOntoOptions(*drop, command);
    AddRunOptions(*drop, command.options);
    CLI::App* replay =
        app.add_subcommand("replay", "play recorded calls again; finds the first step and body that differ");
    replay->add_option("file", file, "of CallRecorder::ToFile, or of run --calls")->type_name("FILE");
    AddThreads(*replay, command.options);
    CLI::App* shrink = app.add_subcommand("shrink",
                                          "find fewer bodies and steps in recorded calls that still fail: by default, "
                                          "that freeze a body since it is not finite");
    shrink->add_option("file", file, "of CallRecorder::ToFile, or of run --calls")->type_name("FILE");
    AddShrinkOptions(*shrink, command.shrink);
    AddThreads(*shrink, command.options);
    CLI::App* list = app.add_subcommand("list", "list the scenes");
    bool wantsVersion = false;
    app.add_flag("--version", wantsVersion, "the version, its commit, compiler and lanes");
    if (!arguments.empty() && arguments[0] == "help") {
        arguments.erase(arguments.begin());
        const std::vector<std::string> names{"run", "export", "drop", "replay", "shrink", "list"};
        if (!arguments.empty() && std::find(names.begin(), names.end(), arguments[0]) == names.end())
            return UnknownName("command", arguments[0], names);
        arguments.push_back("--help");
    }

    Result<std::string> parsed = ParseCommandLine(app, std::move(arguments));
    if (!parsed) return parsed.GetError();
    command.help = parsed.Value();
    if (!command.help.empty()) return command;

    if (wantsVersion) {
        command.kind = CommandKind::Version;
    } else if (run->parsed()) {
        command.kind = CommandKind::Run;
        if (sceneName.empty())
            return Error{ErrorCode::OutOfRange, "run needs a scene's name, for example: ./fulcrum run pyramid"};
        if (IsSceneFile(sceneName)) {
            command.kind = CommandKind::RunFile;
            command.file = sceneName;
        } else if (MaybeError unknown = FindNamed(sceneName, command.scene)) {
            return *unknown;
        }
    } else if (exported->parsed()) {
        command.kind = CommandKind::Export;
        if (!IsSceneFile(file))
            return Error{ErrorCode::OutOfRange,
                         "export needs a scene and a file, for example: ./fulcrum export pyramid pyramid.json"};
        command.file = file;
        if (MaybeError unknown = FindNamed(sceneName, command.scene)) return *unknown;
    } else if (drop->parsed()) {
        command.kind = CommandKind::Drop;
        if (file.empty())
            return Error{ErrorCode::OutOfRange,
                         "drop needs a mesh file, for example: ./fulcrum drop Samples/Meshes/teapot.obj"};
        command.scene = command.onto.empty() ? &DropScene::kScene : &DropOntoScene::kScene;
        command.file = file;
    } else if (replay->parsed() || shrink->parsed()) {
        command.kind = replay->parsed() ? CommandKind::Replay : CommandKind::Shrink;
        if (file.empty())
            return Error{ErrorCode::OutOfRange, std::string(replay->parsed() ? "replay" : "shrink") +
                                                    " needs a file of recorded calls, for example of ./fulcrum run "
                                                    "pyramid --calls pyramid.calls"};
        command.file = file;
    } else if (list->parsed()) {
        command.kind = CommandKind::List;
    } else {
        command.help = app.help();
    }
    return command;
}

}  // namespace fulcrum
