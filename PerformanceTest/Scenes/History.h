// Saved runs over time, as text. Used by the benchmark; prints only.
#pragma once

#include <Fulcrum/PerformanceTest/Scenes/SavedRuns.h>

#include <string>
#include <vector>

namespace fulcrum {

// The saved runs by date, numbered, then for each scene and number of threads a column of bars and its time in each of
// them, relative to the first that has it. Empty `scenes`: all.
std::string HistoryText(std::vector<SavedRuns> saved, const std::vector<std::string>& scenes);

}  // namespace fulcrum
