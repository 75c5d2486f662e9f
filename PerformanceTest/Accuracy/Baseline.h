// The errors of a grid of runs, kept in a file, and what has become of them since: the regression test of accuracy.
// Free functions, any thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

// The errors of all runs and the gates that failed, one run a line: scene, then setting. Seven digits, so that the last
// ones of the closed forms, which mathematical libraries differ in, are not kept.
std::string BaselineOf(std::span<const RunRecord> runs, bool isQuick);
// Error OutOfRange: it cannot be written.
Status SaveBaseline(const std::filesystem::path& path, std::span<const RunRecord> runs, bool isQuick);

struct Comparison {
    // A line each: an error that grew, or is not finite any more; a gate that fails; a run that is not there any more,
    // or that the baseline does not have.
    std::vector<std::string> worse;
    std::vector<std::string> better;  // errors that fell
    size_t same = 0;                  // errors that did neither
};

// Runs are deterministic, so that an error is the same up to the rounding of its digits and of the closed form that it
// is taken from: a part of 2e-6, or 1e-9. Scenes of the baseline without a run are left out. Errors OutOfRange: text is
// no baseline, is of another version, or of the other grid.
Result<Comparison> CompareWithBaseline(const std::string& text, std::span<const RunRecord> runs, bool isQuick);

}  // namespace fulcrum::accuracy
