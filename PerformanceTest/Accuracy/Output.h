// The files of the lab: runs.csv, runs.json, report.html, and tables in Markdown. Called by Main.cpp; one thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

// A scene with its runs. Those of another engine are part of the report, but of no envelope, summary or advice.
struct SceneRuns {
    const LabScene* scene;
    std::vector<RunRecord> runs;
    std::vector<RunRecord> peerRuns{};
    std::string peerLacks{};  // not empty: why the other engine has not run it
};
// Runs in the order of RunLab.
std::vector<SceneRuns> ByScene(std::vector<RunRecord> runs);

// What the numbers were measured with.
struct Circumstances {
    std::string commit{};  // empty: not known
    bool isQuick = false;
    int threads = 1;
    const Peer* peer = nullptr;  // null: none
};

std::string CsvOf(std::span<const SceneRuns> scenes);
// With the schema's version, machine, compiler, lanes, commit, date, summaries and what other engines reach.
nlohmann::ordered_json JsonOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances);
// One page with all of runs.json in it. Error OutOfRange: the page has not been built, or cannot be written.
Status WriteReport(const nlohmann::ordered_json& runs, const std::filesystem::path& path);

// Our default against another engine's, and what that has not run and why.
std::string PeerTable(std::span<const SceneRuns> scenes, const Peer& peer);
// Tables: accuracy scenes, extreme scenes, envelopes, and that of another engine if there is one.
std::string TablesOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances);
// Replaces what is between the marks "accuracy NAME: begin" and "... end" in the file. Error OutOfRange: there are no
// marks, or it cannot be written.
Status WriteTables(const std::string& tables, const std::filesystem::path& path, const std::string& name = "lab");

// "1.2k"; a dash for what is not finite.
std::string ShortNumber(double value);

}  // namespace fulcrum::accuracy
