#include <Fulcrum/PerformanceTest/Accuracy/Options.h>

#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/PerformanceTest/Accuracy/UserScene.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>
#include <Fulcrum/Samples/Runner/CommandLine.h>

#include <cstdlib>
#include <sstream>

namespace fulcrum::accuracy {
namespace {

// "1%", "0.01"; "2ms", "2". Throws CLI::ValidationError.
double NumberWith(const std::string& text, const std::string& unit, double scale, const char* option) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const std::string rest(end);
    if (end == text.c_str() || (!rest.empty() && rest != unit) || !(value > 0))
        throw CLI::ValidationError(option, "'" + text + "' is no positive number with or without " + unit);
    return rest == unit ? value * scale : value;
}

Status ChooseScenes(const std::string& name, LabOptions& lab) {
    if (name == "all") {
        for (const LabScene& scene : AllLabScenes()) lab.scenes.push_back(&scene);
        return Done{};
    }
    lab.scenes = FindLabScenes(name);
    if (!lab.scenes.empty()) return Done{};
    std::vector<std::string> names = LabSceneNames();
    names.push_back("all");
    return UnknownName("scene", name, names);
}

// Of a list with commas.
Status LeaveOut(const std::string& names, LabOptions& lab) {
    std::istringstream list(names);
    for (std::string name; std::getline(list, name, ',');) {
        if (FindLabScenes(name).empty()) return UnknownName("scene", name, LabSceneNames());
        std::erase_if(lab.scenes,
                      [&](const LabScene* scene) { return scene->name == name || scene->FullName() == name; });
    }
    if (lab.scenes.empty()) return Error{ErrorCode::OutOfRange, "--without " + names + " leaves no scene"};
    return Done{};
}

Result<LabCommand> ParseAdvise(std::vector<std::string> arguments) {
    LabCommand command;
    command.lab.isQuick = command.lab.advises = true;
    std::string name;
    CLI::App app("Names the cheapest setting or target for your scene, or one of ours, from a short grid of runs",
                 "./fulcrum advise");
    app.add_option("SCENE", name, "your scene: FILE.json or FILE.cbor; or one of ./fulcrum accuracy or ./fulcrum list")
        ->required();
    AddText(app, "--error", "the largest error to accept, as a part or in per cent: 0.01 or 1%",
            [&](const std::string& text) { command.adviseError = NumberWith(text, "%", 0.01, "--error"); })
        ->type_name("ERROR");
    AddText(app, "--budget", "the largest cost to accept, ms of work per frame of 1/60 s: 2 or 2ms",
            [&](const std::string& text) { command.adviseBudget = NumberWith(text, "ms", 1, "--budget"); })
        ->type_name("TIME");
    AddText(
        app, "--out",
        "folder of the runs (default out/advice, measured anew each time); one that you name is taken over as it is, "
        "and only gets the runs that are missing: name another one after the engine has changed",
        [&](const std::string& text) {
            command.lab.folder = text;
            command.lab.resumes = true;
        })
        ->type_name("DIR");
    command.lab.folder = "out/advice";
    Result<std::string> parsed = ParseCommandLine(app, std::move(arguments));
    if (!parsed) return parsed.GetError();
    command.help = parsed.Value();
    if (!command.help.empty()) return command;
    if (!command.adviseError && !command.adviseBudget)
        return Error{ErrorCode::OutOfRange, "advise needs --error or --budget (./fulcrum advise --help)"};
    command.lab.scenes = FindLabScenes(name);
    if (!command.lab.scenes.empty()) return command;
    const Result<const LabScene*> scene = LoadUserScene(name);
    if (!scene) return scene.GetError();
    command.lab.scenes = {scene.Value()};
    command.lab.resumes = false;  // the file may have changed
    return command;
}

}  // namespace

Result<LabCommand> ParseLabCommand(std::vector<std::string> arguments) {
    if (!arguments.empty() && arguments[0] == "advise") {
        arguments.erase(arguments.begin());
        return ParseAdvise(std::move(arguments));
    }
    LabCommand command;
    command.lab.folder = "out/accuracy";
    std::string name = "all", without;
    CLI::App app("Speed against accuracy: runs scenes over a grid of settings", "./fulcrum accuracy");
    AddText(app, "--scene", "a scene's name, or all (default all)", [&](const std::string& text) {
        name = text;
    })->type_name("SCENE");
    AddText(app, "--without", "leave these scenes out: names with commas", [&](const std::string& text) {
        without = text;
    })->type_name("SCENE,...");
    app.add_flag_function(
        "--quick", [&](int64_t) { command.lab.isQuick = true; },
        "about 12 settings a scene and short runs: some minutes. The full grid takes more than a day");
    AddInteger(app, "--threads", 1, 64,
               "runs at a time (default 1); more than cores, or a busy machine, spoil the costs",
               [&](int value) { command.lab.threads = value; });
    AddText(app, "--out", "folder of runs.jsonl, runs.csv, runs.json, tables.md, report.html (default out/accuracy)",
            [&](const std::string& text) { command.lab.folder = text; })
        ->type_name("DIR");
    app.add_flag_function(
        "--resume", [&](int64_t) { command.lab.resumes = true; },
        "take over the runs that DIR has, which must be of the same build, and make the others");
    AddText(app, "--peer", "also run the scenes in another engine, as far as it has what they need: bullet",
            [&](const std::string& engine) {
                const Result<const Peer*> peer = FindPeer(engine, "accuracy");
                if (!peer) throw CLI::ValidationError(peer.GetError().message);
                command.lab.peer = peer.Value();
            })
        ->type_name("ENGINE");
    AddText(app, "--table",
            "write the tables between the marks of this document, too; with --peer that of both engines",
            [&](const std::string& text) { command.table = text; })
        ->type_name("FILE");
    app.add_flag_function(
        "--once", [&](int64_t) { command.lab.isTimedOnce = true; },
        "time each run once: enough for the errors, in a fifth of the time");
    AddText(app, "--save", "write what --baseline takes: the errors of all runs", [&](const std::string& text) {
        command.save = text;
    })->type_name("FILE");
    AddText(app, "--baseline", "compare the errors with those of this file; exit status 1 where one is larger",
            [&](const std::string& text) { command.baseline = text; })
        ->type_name("FILE");
    app.add_flag("--soak", command.soaks,
                 "10^6 steps of the scene soak at the default setting, with 1 thread, then with 2, and nothing else: "
                 "some minutes; exit status 1 where a requirement fails");
    app.add_flag(
        "--recordings", command.recordings.isOfAll,
        "record all runs to pages in DIR/recordings, which the dots of the report link to: about a megabyte each");
    AddText(app, "--record", "record the runs with this setting, as hovering shows it: --record \"soft 1/60 4 1 1\"",
            [&](const std::string& text) { command.recordings.setting = text; })
        ->type_name("SETTING");
    app.add_flag_function(
        "--targets", [&](int64_t) { command.lab.comparesTargets = command.lab.isTimedOnce = true; },
        "runs with AccuracyTargets against runs with fixed efforts, and nothing else: what an error costs either way, "
        "to DIR/targets");
    AddText(app, "--commit", "what runs.json says of the version",
            [&](const std::string& text) { command.commit = text; });
    Result<std::string> parsed = ParseCommandLine(app, std::move(arguments));
    if (!parsed) return parsed.GetError();
    command.help = parsed.Value();
    command.recordings.isQuick = command.lab.isQuick;
    if (command.lab.peer && (command.soaks || command.lab.comparesTargets))
        return Error{ErrorCode::OutOfRange, "--peer goes without --soak and --targets"};
    if (command.soaks) {
        if (name != "all" || command.lab.isQuick || !command.baseline.empty() || !command.save.empty())
            return Error{ErrorCode::OutOfRange, "--soak is a run of its own: no --scene, --quick, --save, --baseline"};
        name = "soak";
        command.lab.settings = {Setting{}};
        command.lab.isTimedOnce = true;
        command.lab.folder /= "soak";
    }
    if (const Status chosen = ChooseScenes(name, command.lab); !chosen) return chosen.GetError();
    if (const Status left = LeaveOut(without, command.lab); !left) return left.GetError();
    if (command.lab.comparesTargets) {
        if (command.soaks || !command.baseline.empty() || !command.save.empty())
            return Error{ErrorCode::OutOfRange, "--targets goes without --soak, --save and --baseline"};
        command.lab.folder /= "targets";
        // Where nothing is solved, and where thousands of bodies are at one point, efforts do not matter.
        std::erase_if(command.lab.scenes, [](const LabScene* scene) {
            return TargetGrid(scene->influences).empty() || scene->FullName() == "coincident.4096";
        });
    }
    return command;
}

}  // namespace fulcrum::accuracy
