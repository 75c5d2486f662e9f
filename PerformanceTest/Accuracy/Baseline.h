// Regression test of accuracy: saves the errors of a grid of runs and their work to a file, and compares later runs
// with it. Free functions, any thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

// The errors of all runs, the requirements that failed and the traversals of constraints per simulated second, which
// are the same on every machine; one line per run: scene, then setting. Seven digits, so that the last ones of the
// closed forms, which mathematical libraries differ in, are not kept.
std::string BaselineOf(std::span<const RunRecord> runs, bool isQuick);
// Error OutOfRange: the file cannot be written.
Status SaveBaseline(const std::filesystem::path& path, std::span<const RunRecord> runs, bool isQuick);

struct Comparison {
    // One line each: an error that increased or is no longer finite; a requirement that fails; a run that is missing,
    // or that the baseline does not have; traversals that increased by more than kDearer.
    std::vector<std::string> worse;
    std::vector<std::string> better;  // errors that decreased; traversals that did by more than kDearer
    size_t same = 0;                  // unchanged errors
    // Traversals over those of the baseline: of each run, by scene and setting.
    struct CostRatio {
        std::string run;
        double ratio;
    };
    std::vector<CostRatio> costs;
};

// More work than this, over that of the baseline, fails: efforts follow residuals, which change with anything.
inline constexpr double kDearer = 0.1;

// Runs are deterministic, so that an error is the same up to the rounding of its digits and of the closed form that it
// is taken from: relative 2e-6, or absolute 1e-9. Scenes of the baseline without a run are skipped. Errors OutOfRange:
// text is no baseline, is of another version, or of the other grid.
Result<Comparison> CompareWithBaseline(const std::string& text, std::span<const RunRecord> runs, bool isQuick);

}  // namespace fulcrum::accuracy
