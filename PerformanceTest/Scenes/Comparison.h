// Compares runs with those of a baseline. Used by the benchmark; pure functions but for the printing.
#pragma once

#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>
#include <Fulcrum/PerformanceTest/Scenes/SavedRuns.h>

#include <string>
#include <vector>

namespace fulcrum {

// Of the intervals. A call compares dozens of scenes: at 95 % one would fall outside by chance each time.
inline constexpr double kComparisonConfidence = 0.99;
inline constexpr int kFewestComparedRuns = 5;  // with fewer no interval has that confidence

struct ComparedRun {
    std::string scene;
    int threads = 1;
    double baselineMs = 0, ms = 0;
    RatioEstimate time{};  // of the relative times
    Verdict verdict = Verdict::Same;
    std::optional<double> baselineAccuracy, accuracy;
    bool isAccuracyWorse = false;
    bool hasHashChanged = false;
    std::string remark;  // what else differs; may be empty

    bool IsWorse() const { return verdict == Verdict::Slower || isAccuracyWorse; }
};

// By how much the accuracy figure's magnitude may grow; null: it is not compared.
using AccuracyTolerance = std::optional<double> (*)(const std::string& scene);

// An error OutOfRange where the baseline has no such run, or too few times of it.
MaybeError CheckComparable(const SavedRuns& baseline, const std::string& scene, int threads);

// Every run of `now` with that of the baseline. Error: CheckComparable's.
Result<std::vector<ComparedRun>> CompareRuns(const SavedRuns& now, const SavedRuns& baseline, double tolerance,
                                             AccuracyTolerance accuracyTolerance);

// Of machine and build; one line each, empty where nothing differs.
std::vector<std::string> DifferencesOfMachines(const SavedRuns& now, const SavedRuns& baseline);

// A line each; `onlyWorse` leaves out the others.
void PrintComparison(const std::vector<ComparedRun>& runs, double tolerance, bool onlyWorse);

// Of the program: 1 where a run is worse.
int ExitStatusOf(const std::vector<ComparedRun>& runs);

}  // namespace fulcrum
