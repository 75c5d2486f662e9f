// Times performance scenes, for ./fulcrum bench. Called by Main.cpp; one thread besides the pool that it makes.
#pragma once

#include <Fulcrum/Samples/Runner/Simulation.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fulcrum {

struct BenchOptions {
    std::vector<const Scene*> scenes;
    int threads = 1;
    int steps = 0;  // 0: the scene's own number
    int runs = 1;   // of each scene, of which the one with the lowest median counts
    // Whether there are runs for accuracy besides: with sleeping, and with other gravity where a scene wants that.
    bool accuracyRuns = true;
    SolverSettings solver;
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    uint64_t seed = 1;
    std::filesystem::path json;  // empty: none
    std::string help;            // not empty: only help was requested
};

// Arguments without the program's name. Error OutOfRange as ParseRunnerCommand's.
Result<BenchOptions> ParseBenchOptions(std::vector<std::string> arguments);

// 1 untimed step, then the timed ones, as benchmarks of other engines do it; or the scene's batch of queries. The one
// with the lowest median of options.runs; then the runs for accuracy.
Result<RunFigures> TimeScene(const Scene& scene, const BenchOptions& options);

// Prints a table of times line by line, then one of accuracy, writes the JSON. Returns the exit status.
int RunBench(const BenchOptions& options);

}  // namespace fulcrum
