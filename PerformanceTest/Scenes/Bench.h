// Times scenes, for ./fulcrum bench. Called by Main.cpp; one thread besides the pools of the scenes.
#pragma once

#include <Fulcrum/PerformanceTest/Scenes/BenchOptions.h>

namespace fulcrum {

// Prints a table of times line by line, then one of accuracy, then the comparison with the baseline; writes the JSON.
// Or prints a history. Returns the exit status: 0; 1 if a scene is worse than in the baseline; 2 if input is missing or
// damaged.
int RunBench(const BenchOptions& options);

}  // namespace fulcrum
