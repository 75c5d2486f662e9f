// The files of the lab: runs.csv, runs.json, report.html, and tables in Markdown. Called by Main.cpp; one thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

// A scene with its runs.
struct SceneRuns {
    const LabScene* scene;
    std::vector<RunRecord> runs;
};
// Runs in the order of RunLab.
std::vector<SceneRuns> ByScene(std::vector<RunRecord> runs);

// What the numbers were measured with.
struct Circumstances {
    std::string commit;  // empty: not known
    bool isQuick = false;
    int threads = 1;
};

std::string CsvOf(std::span<const SceneRuns> scenes);
// With the schema's version, machine, compiler, lanes, commit, date, summaries and what other engines reach.
nlohmann::ordered_json JsonOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances);
// One page with all of runs.json in it. Error OutOfRange: the page has not been built, or cannot be written.
Status WriteReport(const nlohmann::ordered_json& runs, const std::filesystem::path& path);

// Tables: accuracy scenes, extreme scenes, envelopes.
std::string TablesOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances);
// Replaces what is between the marks "accuracy NAME: begin" and "... end" in the file. Error OutOfRange: there are no
// marks, or it cannot be written.
Status WriteTables(const std::string& tables, const std::filesystem::path& path, const std::string& name = "lab");

// "1.2k"; a dash for what is not finite.
std::string ShortNumber(double value);

}  // namespace fulcrum::accuracy
