// The record of one run of the lab, and its line in runs.jsonl. Plain data and free functions, any thread.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <nlohmann/json_fwd.hpp>

#include <limits>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

inline constexpr int kSchemaVersion = 2;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct RunRecord {
    std::string scene;  // full name
    Setting setting;
    std::vector<NamedValue> errors, figures;  // medians over the seeds; the first error is the main one
    std::vector<double> observed;
    std::vector<std::string> failedConditions;  // of any seed
    std::string worst;                          // of the first seed, see LabRun
    bool isMeasured = true;                     // likewise
    bool blewUp = false;                        // the main error is not finite, or beyond the scene's bound
    int seeds = 1;
    uint64_t hash = 0;
    double traversals = 0;    // of constraints per simulated second
    int effortReturns = 0;    // of the first seed, see Work
    double microseconds = 0;  // of work per simulated second: the median of so many runs
    int timedRuns = 0;
    double selfError = kNaN;  // from the finest setting, not from the closed form; AddSelfErrors fills it
    double costRatio = kNaN;  // to the default setting's; AddCostRatios fills it
    std::string unsupported;  // not empty: what the other engine lacks for this scene, which was not run then
    std::string recording;    // the file, relative to the lab's folder; empty: none. FindRecordings fills it

    // The main error; NaN if the scene reported none.
    double Error() const { return errors.empty() ? kNaN : errors[0].value; }
};

// Runs the scene with each of its seeds, and, unless isTimedOnce, repeats it until there are five times or a share of
// time is used up. Another engine's traversals are NaN, and so are its errors where its numbers were not finite.
RunRecord Measure(const LabScene& scene, const Setting& setting, bool isQuick, bool isTimedOnce = false);

// Not finite: null.
nlohmann::ordered_json ToJson(const RunRecord& record);
// Errors: OutOfRange (no run, or an unknown one), Unsupported (of another engine, without which this program was
// built).
Result<RunRecord> RecordFromJson(const nlohmann::ordered_json& json);

// Of one scene, in any order: sets the self errors: the largest difference of a run's observed values from those of the
// finest soft setting, of another engine from those of its own finest. NaN if there is none, or if the number of values
// differs.
void AddSelfErrors(std::vector<RunRecord>& ofScene);

// Of one scene, in any order: sets the cost ratios: the cost of each run relative to the default setting. NaN if there
// is none.
void AddCostRatios(std::vector<RunRecord>& ofScene);

}  // namespace fulcrum::accuracy
