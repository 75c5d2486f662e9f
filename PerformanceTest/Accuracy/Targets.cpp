#include <Fulcrum/PerformanceTest/Accuracy/Targets.h>

#include <algorithm>
#include <cstdio>

namespace fulcrum::accuracy {
namespace {

constexpr int kFewReturns = 2;

bool Reaches(const RunRecord& run, double error) { return !run.blewUp && run.Error() <= error; }

std::string EffortText(const RunRecord& run) {
    const Setting& setting = run.setting;
    std::string text = "1/" + std::to_string(setting.rate) + ", " + std::to_string(setting.solver.substeps);
    if (setting.family == Family::Target) text += ", " + setting.TargetText();
    return text + ": " + ShortNumber(run.Error()) + " @ " + ShortNumber(run.traversals);
}

std::string RatioText(double ratio) {
    char text[16];
    std::snprintf(text, sizeof text, ratio <= kMostOverFixed ? "%.2f" : "**%.2f**", ratio);
    return text;
}

}  // namespace

double TargetCost::Ratio() const {
    if (!fixed) return kNaN;
    return target ? target->traversals / fixed->traversals : std::numeric_limits<double>::infinity();
}

TargetCost CompareTarget(std::span<const RunRecord> runs, double error) {
    TargetCost cost{error};
    for (const RunRecord& run : runs) {
        const Family family = run.setting.family;
        if ((family != Family::Fixed && family != Family::Target) || !Reaches(run, error)) continue;
        const RunRecord*& best = family == Family::Fixed ? cost.fixed : cost.target;
        if (!best || run.traversals < best->traversals) best = &run;
    }
    return cost;
}

std::string TargetTable(std::span<const SceneRuns> scenes) {
    std::string rows;
    std::string returning;
    int all = 0, within = 0, effortless = 0;
    for (const SceneRuns& each : scenes) {
        int returns = 0;
        for (const RunRecord& run : each.runs)
            if (run.setting.family == Family::Target) returns = std::max(returns, run.effortReturns);
        if (returns > kFewReturns)
            returning += (returning.empty() ? "`" : ", `") + each.scene->FullName() + "` " + std::to_string(returns);
        for (const double error : {0.1, 0.01, 0.001}) {
            const TargetCost cost = CompareTarget(each.runs, error);
            if (!cost.fixed || !(cost.fixed->traversals > 0)) continue;
            ++all;
            within += cost.Ratio() <= kMostOverFixed;
            // What the least effort reaches says nothing of targets.
            const bool isEffortless = cost.fixed->setting.solver.substeps == 1 && cost.Ratio() <= kMostOverFixed;
            effortless += isEffortless;
            if (isEffortless) continue;
            rows += "| `" + each.scene->FullName() + "` | " + ShortNumber(100 * error) + " % | " +
                    EffortText(*cost.fixed) + " | " + (cost.target ? EffortText(*cost.target) : "never") + " | " +
                    RatioText(cost.Ratio()) + " |\n";
        }
    }
    return "| scene | error | cheapest fixed effort: dt, substeps: error @ cost | cheapest target: dt, substeps, "
           "target: "
           "error @ cost | cost over the fixed one's |\n| --- | --- | --- | --- | --- |\n" +
           rows + "\nOf " + std::to_string(all) + " pairs of a scene and an error that some fixed effort reaches, " +
           std::to_string(within) + " cost at most 1.3 times as much with a target; " + std::to_string(effortless) +
           " of these, which one substep reaches, are not listed. The effort of an island rose again after it had "
           "fallen, though its contacts and joints had stayed the same, in the second half of a run, more than twice "
           "in: " +
           (returning.empty() ? "none" : returning) + ".\n";
}

}  // namespace fulcrum::accuracy
