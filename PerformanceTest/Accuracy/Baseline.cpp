#include <Fulcrum/PerformanceTest/Accuracy/Baseline.h>

#include <Fulcrum/Physics/Files/WholeFile.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace fulcrum::accuracy {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSameFraction = 2e-6, kSameError = 1e-9;

std::string Digits(double value) {
    if (!std::isfinite(value)) return "null";
    char text[32];
    std::snprintf(text, sizeof text, "%.7g", value);
    return text;
}

std::string LineOf(const RunRecord& run) {
    std::string line = Json(run.setting.Key()).dump() + ": {\"errors\": {";
    for (const NamedValue& error : run.errors)
        line += (&error == run.errors.data() ? "" : ", ") + Json(error.name).dump() + ": " + Digits(error.value);
    line += "}, \"traversals\": " + Digits(run.traversals);
    if (!run.failedConditions.empty()) line += ", \"failed_conditions\": " + Json(run.failedConditions).dump();
    return line + "}";
}

// The work of a run against that of the baseline.
void CompareCost(const RunRecord& run, const std::string& name, const Json& before, Comparison& comparison) {
    const Json& was = before.at("traversals");
    const double from = was.is_null() ? kNaN : was.get<double>(), to = run.traversals;
    if (from == 0 && to == 0) return;
    const double ratio = to / from;
    if (std::isfinite(ratio) && ratio > 0) comparison.costs.push_back({run.scene + ", " + run.setting.Key(), ratio});
    const std::string change = name + "traversals per second " + Digits(from) + " -> " + Digits(to);
    if (!(ratio <= 1 + kDearer)) comparison.worse.push_back(change);
    else if (ratio < 1 - kDearer) comparison.better.push_back(change);
}

// One run against that of the baseline.
void CompareRun(const RunRecord& run, const Json& before, Comparison& comparison) {
    const std::string name = run.scene + ", " + run.setting.Key() + ": ";
    const Json none = Json::array(),
               &conditions = before.contains("failed_conditions") ? before["failed_conditions"] : none;
    for (const std::string& condition : run.failedConditions)
        if (std::find(conditions.begin(), conditions.end(), Json(condition)) == conditions.end())
            comparison.worse.push_back(name + "fails " + condition);
    CompareCost(run, name, before, comparison);
    const Json& errors = before.at("errors");
    std::set<std::string> found;
    for (const NamedValue& error : run.errors) {
        found.insert(error.name);
        if (!errors.contains(error.name)) {
            comparison.worse.push_back(name + error.name + " is not in the baseline");
            continue;
        }
        const Json& was = errors[error.name];
        const double from = was.is_null() ? kNaN : was.get<double>(), to = error.value;
        const std::string change = name + error.name + " " + Digits(from) + " -> " + Digits(to);
        const double tolerance = kSameError + kSameFraction * std::fabs(from);
        const bool hadNumber = std::isfinite(from);
        if (hadNumber && !(to <= from + tolerance)) comparison.worse.push_back(change);
        else if (hadNumber ? to < from - tolerance : std::isfinite(to)) comparison.better.push_back(change);
        else ++comparison.same;
    }
    for (const auto& [error, value] : errors.items())
        if (!found.contains(error)) comparison.worse.push_back(name + error + " is not measured any more");
}

}  // namespace

std::string BaselineOf(std::span<const RunRecord> runs, bool isQuick) {
    std::string text = "{\"fulcrum_accuracy_baseline\": " + std::to_string(kSchemaVersion) +
                       ", \"quick\": " + (isQuick ? "true" : "false") + ", \"scenes\": {";
    const RunRecord* last = nullptr;
    for (const RunRecord& run : runs) {
        if (run.setting.peer) continue;
        const bool isSame = last && last->scene == run.scene;
        if (!isSame) text += (last ? "\n}," : "") + ("\n" + Json(run.scene).dump()) + ": {";
        text += (isSame ? ",\n" : "\n") + LineOf(run);
        last = &run;
    }
    return text + (last ? "\n}" : "") + "}}\n";
}

Status SaveBaseline(const std::filesystem::path& path, std::span<const RunRecord> runs, bool isQuick) {
    return WriteWholeFile(path, {BaselineOf(runs, isQuick)}, MissingFolders::AreCreated);
}

Result<Comparison> CompareWithBaseline(const std::string& text, std::span<const RunRecord> runs, bool isQuick) {
    try {
        const Json baseline = Json::parse(text);
        if (baseline.at("fulcrum_accuracy_baseline").get<int>() != kSchemaVersion)
            return Error{ErrorCode::OutOfRange, "the baseline is of another version"};
        if (baseline.at("quick").get<bool>() != isQuick)
            return Error{ErrorCode::OutOfRange,
                         isQuick ? "the baseline is of the full grid" : "the baseline is of the quick grid: --quick"};
        const Json& scenes = baseline.at("scenes");
        for (const auto& [scene, settings] : scenes.items())
            if (!settings.is_object()) return Error{ErrorCode::OutOfRange, "the baseline has no runs of " + scene};
        Comparison comparison;
        std::set<std::pair<std::string, std::string>> made;
        for (const RunRecord& run : runs) {
            if (run.setting.peer) continue;
            const std::string key = run.setting.Key();
            made.insert({run.scene, key});
            if (!scenes.contains(run.scene) || !scenes[run.scene].contains(key))
                comparison.worse.push_back(run.scene + ", " + key + ": not in the baseline");
            else CompareRun(run, scenes[run.scene][key], comparison);
        }
        for (const auto& [scene, settings] : scenes.items()) {
            const bool isRun = std::ranges::find(runs, scene, &RunRecord::scene) != runs.end();
            for (const auto& [key, values] : settings.items())
                if (isRun && !made.contains({scene, key}))
                    comparison.worse.push_back(scene + ", " + key + ": there is no such run any more");
        }
        return comparison;
    } catch (const nlohmann::json::exception& error) {
        return Error{ErrorCode::OutOfRange, std::string("no baseline of the lab: ") + error.what()};
    }
}

}  // namespace fulcrum::accuracy
