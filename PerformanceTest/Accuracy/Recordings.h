// Recordings of runs as pages that play them, to which the report's dots link. Any thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <filesystem>
#include <span>
#include <string>

namespace fulcrum::accuracy {

struct RecordingOptions {
    bool isOfAll = false;  // of every run
    std::string setting;   // or of the runs with this key; empty: none
    bool isQuick = false;
    bool showsProgress = true;  // on stderr
    bool AreWanted() const { return isOfAll || !setting.empty(); }
};

// "recordings/incline.slide_soft_1-60_4_1_1.html", in the lab's folder.
std::string RecordingPath(const RunRecord& run);

// Repeats the runs with their first seeds and writes their pages to the folder. Errors OutOfRange: no run has the
// setting, which names those that there are; a page cannot be written.
Status WriteRecordings(std::span<const RunRecord> runs, const RecordingOptions& options,
                       const std::filesystem::path& folder);

// Names the page of each run that the folder has one of.
void FindRecordings(std::span<RunRecord> runs, const std::filesystem::path& folder);

}  // namespace fulcrum::accuracy
