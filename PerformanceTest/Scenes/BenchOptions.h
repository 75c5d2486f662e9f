// The command line of ./fulcrum bench. Pure function of the arguments.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Samples/Scenes/Scene.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fulcrum {

struct Peer;

struct BenchOptions {
    std::vector<const Scene*> scenes;  // empty: those of the baseline if there is one, else the performance scenes
    std::vector<int> threads;          // likewise, else 1
    double dt = 1.0 / 60;              // s
    int steps = 0;                     // 0: the scene's own number
    int runs = 1;                      // rounds over all scenes
    // Whether there are runs for accuracy besides: with sleeping, and with other gravity where a scene wants that.
    bool accuracyRuns = true;
    bool quiet = false;
    SolverSettings solver;
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    uint64_t seed = 1;
    std::filesystem::path json, save, baseline;  // empty: none
    double tolerance = 0.1;                      // by which a scene may be slower than in the baseline
    std::vector<std::string> history;            // files; if there are any, nothing is timed
    const Peer* peer = nullptr;                  // null: none
    std::string help;                            // not empty: only help was requested
};

// Arguments without the program's name. Error OutOfRange as ParseRunnerCommand's.
Result<BenchOptions> ParseBenchOptions(std::vector<std::string> arguments);

}  // namespace fulcrum
