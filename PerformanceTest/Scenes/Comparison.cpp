#include <Fulcrum/PerformanceTest/Scenes/Comparison.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fulcrum {
namespace {

void AddRemark(std::string& remark, const std::string& text) { remark += (remark.empty() ? "" : "; ") + text; }

std::string SettingsRemark(const SavedRun& now, const SavedRun& baseline) {
    std::string remark;
    if (now.steps != baseline.steps)
        AddRemark(remark, "steps " + std::to_string(baseline.steps) + " -> " + std::to_string(now.steps));
    for (const auto& [name, value] : now.settings.items()) {
        const auto before = baseline.settings.find(name);
        if (before == baseline.settings.end()) AddRemark(remark, name + " is new: " + value.dump());
        else if (*before != value) AddRemark(remark, name + " " + before->dump() + " -> " + value.dump());
    }
    return remark;
}

// Larger is worse, whatever the sign: the figures are errors.
bool IsAccuracyWorse(const SavedRun& now, const SavedRun& baseline, std::optional<double> tolerance) {
    if (now.nonFinite > baseline.nonFinite) return true;
    if (!tolerance || now.accuracyRuns != baseline.accuracyRuns || !baseline.accuracy) return false;
    return !now.accuracy || std::fabs(*now.accuracy) > std::fabs(*baseline.accuracy) + *tolerance;
}

ComparedRun Compare(const SavedRun& now, const SavedRun& baseline, double tolerance,
                    std::optional<double> accuracyTolerance, bool isSameMachine) {
    ComparedRun compared{.scene = now.scene,
                         .threads = now.threads,
                         .baselineMs = baseline.medianMs,
                         .ms = now.medianMs,
                         .time = CompareSamples(now.relativeTimes, baseline.relativeTimes, kComparisonConfidence),
                         .baselineAccuracy = baseline.accuracy,
                         .accuracy = now.accuracy,
                         .isAccuracyWorse = IsAccuracyWorse(now, baseline, accuracyTolerance),
                         .hasHashChanged = now.hash != baseline.hash,
                         .remark = SettingsRemark(now, baseline)};
    compared.verdict = JudgeRatio(compared.time, tolerance);
    // Other programs may slow the kernel down more than the scene. The real change is between that of the relative
    // times and that of the clock: if these have opposite signs, the result is undecided.
    const bool isOpposite = compared.verdict == Verdict::Slower   ? compared.ms < compared.baselineMs
                            : compared.verdict == Verdict::Faster ? compared.ms > compared.baselineMs
                                                                  : false;
    if (isSameMachine && isOpposite) {
        AddRemark(compared.remark,
                  std::string("called the same: not ") + VerdictName(compared.verdict) + " by the clock");
        compared.verdict = Verdict::Same;
    }
    if (now.nonFinite > baseline.nonFinite)
        AddRemark(compared.remark, std::to_string(now.nonFinite) + " bodies are not finite");
    if (now.accuracyRuns != baseline.accuracyRuns)
        AddRemark(compared.remark, "accuracy is not compared: the median of " + std::to_string(baseline.accuracyRuns) +
                                       " runs -> of " + std::to_string(now.accuracyRuns));
    return compared;
}

std::string AccuracyText(std::optional<double> accuracy) {
    if (!accuracy) return "none";
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", *accuracy);
    return text;
}

std::string AccuracyChange(const ComparedRun& run) {
    const std::string before = AccuracyText(run.baselineAccuracy), now = AccuracyText(run.accuracy);
    return (before == now ? now : before + " -> " + now) + (run.isAccuracyWorse ? " WORSE" : "");
}

}  // namespace

MaybeError CheckComparable(const SavedRuns& baseline, const std::string& scene, int threads) {
    const std::string name = scene + " with " + std::to_string(threads) + (threads == 1 ? " thread" : " threads");
    const SavedRun* run = baseline.Find(scene, threads);
    if (!run) {
        std::string has;
        for (const SavedRun& other : baseline.runs)
            has += (has.empty() ? "" : ", ") + other.scene + " (" + std::to_string(other.threads) + ")";
        return Error{ErrorCode::OutOfRange,
                     baseline.file + ": has no run of " + name + "; it has " + (has.empty() ? "none" : has)};
    }
    if (run->relativeTimes.size() < kFewestComparedRuns)
        return Error{ErrorCode::OutOfRange, baseline.file + ": has only " + std::to_string(run->relativeTimes.size()) +
                                                " runs of " + name + ", and a comparison needs " +
                                                std::to_string(kFewestComparedRuns) + "; `bench --save` saves enough"};
    return std::nullopt;
}

Result<std::vector<ComparedRun>> CompareRuns(const SavedRuns& now, const SavedRuns& baseline, double tolerance,
                                             AccuracyTolerance accuracyTolerance) {
    std::vector<ComparedRun> compared;
    for (const SavedRun& run : now.runs) {
        if (MaybeError error = CheckComparable(baseline, run.scene, run.threads)) return *error;
        const SavedRun& before = *baseline.Find(run.scene, run.threads);
        compared.push_back(Compare(run, before, tolerance, accuracyTolerance(run.scene), now.cpu == baseline.cpu));
    }
    return compared;
}

std::vector<std::string> DifferencesOfMachines(const SavedRuns& now, const SavedRuns& baseline) {
    std::vector<std::string> differences;
    const auto compare = [&](const char* what, const std::string& before, const std::string& after) {
        if (before != after) differences.push_back(std::string(what) + ": " + before + " -> " + after);
    };
    compare("processor", baseline.cpu, now.cpu);
    compare("cores", std::to_string(baseline.cores), std::to_string(now.cores));
    compare("compiler", baseline.compiler, now.compiler);
    compare("lanes", std::to_string(baseline.lanes), std::to_string(now.lanes));
    return differences;
}

void PrintComparison(const std::vector<ComparedRun>& runs, double tolerance, bool onlyWorse) {
    const bool isEmpty = onlyWorse && std::none_of(runs.begin(), runs.end(), [](auto& run) { return run.IsWorse(); });
    if (isEmpty) return;
    std::printf("\n%-16s %3s  %9s %9s  %6s  %-14s  %-7s  %-22s  %s\n", "scene", "thr", "before ms", "now ms", "time",
                "99 % interval", "is", "accuracy", "hash");
    int counts[3] = {}, worse = 0;
    for (const ComparedRun& run : runs) {
        ++counts[static_cast<int>(run.verdict)];
        worse += run.isAccuracyWorse;
        if (onlyWorse && !run.IsWorse()) continue;
        char interval[32];
        std::snprintf(interval, sizeof interval, "%.3f..%.3f", run.time.interval.low, run.time.interval.high);
        std::printf("%-16s %3d  %9.4f %9.4f  %6.3f  %-14s  %-7s  %-22s  %s\n", run.scene.c_str(), run.threads,
                    run.baselineMs, run.ms, run.time.ratio, interval, VerdictName(run.verdict),
                    AccuracyChange(run).c_str(), run.hasHashChanged ? "changed" : "same");
        if (!run.remark.empty()) std::printf("%20s %s\n", "", run.remark.c_str());
    }
    std::printf(
        "%d slower, %d faster, %d same (tolerance %g %%), %d less accurate; time: over the baseline's, both "
        "measured in units of the reference kernel\n",
        counts[static_cast<int>(Verdict::Slower)], counts[static_cast<int>(Verdict::Faster)],
        counts[static_cast<int>(Verdict::Same)], 100 * tolerance, worse);
}

int ExitStatusOf(const std::vector<ComparedRun>& runs) {
    return std::any_of(runs.begin(), runs.end(), [](const ComparedRun& run) { return run.IsWorse(); }) ? 1 : 0;
}

}  // namespace fulcrum
