// What an error costs with an AccuracyTarget, against the cheapest fixed effort that reaches it. Pure functions.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/Output.h>

#include <span>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

// Of one scene and a stated error: the cheapest run of either kind whose error is at most that, and their costs'
// quotient. Costs are constraint traversals, the same on every machine; null where no run reaches it.
struct TargetCost {
    double error;
    const RunRecord* fixed = nullptr;
    const RunRecord* target = nullptr;
    double Ratio() const;  // NaN without a fixed run, infinite without a target
};
TargetCost CompareTarget(std::span<const RunRecord> runs, double error);

// A target may cost so many times what the cheapest fixed effort costs.
inline constexpr double kMostOverFixed = 1.3;

// In Markdown: a row for each scene and each of 10 %, 1 % and 0.1 % where a fixed effort is dearer than the cheapest of
// all, and a line that counts.
std::string TargetTable(std::span<const SceneRuns> scenes);

}  // namespace fulcrum::accuracy
