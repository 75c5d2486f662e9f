// The command line options of `fulcrum run`, `export`, `drop`, `replay`, `shrink`, `list`, `help` and `--version`. Read
// by Main.cpp; pure function of the arguments.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Assets/Meshes/MeshImport.h>
#include <Fulcrum/Samples/Scenes/Scene.h>

#include <CLI/App.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

struct RunOptions {
    std::optional<int> steps;
    std::optional<double> seconds;
    std::optional<double> givenDt;  // --dt
    double dt = 1.0 / 60;           // that of the run
    int threads = 1;
    SolverSettings solver;
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    bool errors = false;  // --errors
    bool recordHtml = true, recordGlb = true;
    std::filesystem::path json;         // empty: none
    std::filesystem::path out = "out";  // folder of what is recorded
    std::filesystem::path calls;        // --calls; empty: none
    bool isQuiet = false;               // nothing is said but what goes wrong
    uint64_t seed = 1;

    // --steps, else --seconds over dt rounded up, else the scene's own duration at this dt.
    int StepsOf(const Scene& scene) const;
};

enum class CommandKind { Help, Version, List, Run, RunFile, Export, Drop, Replay, Shrink };

// What a program is shrunk for, see Physics/Recording/Shrink.h.
struct ShrinkOptions {
    std::optional<double> speed, below;     // m/s, m
    bool differs = false, crashes = false;  // none of them: a frozen body
    std::filesystem::path out;              // empty: beside the recording
};

struct Command {
    CommandKind kind = CommandKind::Help;
    std::string help;              // Help
    const Scene* scene = nullptr;  // Run, Export, Drop
    std::filesystem::path file;    // RunFile, Export, Drop, Replay, Shrink
    int count = 50;                // Drop
    std::filesystem::path onto;    // Drop; empty: onto a floor
    MeshImportSettings ontoSettings;
    RunOptions options;  // Run, RunFile, Drop; threads also of Replay and Shrink
    ShrinkOptions shrink;
};

// Arguments without the program's name. Error OutOfRange: one line that says what is wrong and what was probably meant.
Result<Command> ParseRunnerCommand(std::vector<std::string> arguments);

// --preset, --substeps, --velocity-iterations, --position-iterations, --position-correction: the benchmark has them
// too.
void AddSolverOptions(CLI::App& app, SolverSettings& solver);
// As --position-correction takes it.
const char* PositionCorrectionName(PositionCorrection correction);
// --narrow-phase, likewise. The names are those it takes.
void AddNarrowPhaseOption(CLI::App& app, NarrowPhaseMethod& method);
const char* NarrowPhaseName(NarrowPhaseMethod method);

inline constexpr int kMostSteps = 10'000'000;
inline constexpr int kMostThreads = 64;  // as ThreadPool
std::vector<std::string> SceneNames();

}  // namespace fulcrum
