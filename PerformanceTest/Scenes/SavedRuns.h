// What `bench --json` and `--save` write and `--baseline` and `--history` read: runs of scenes with the machine and the
// build that they ran on. Used by the benchmark; one thread.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

// The data of a scene with a number of threads that a comparison needs.
struct SavedRun {
    std::string scene;
    int threads = 1;
    double medianMs = 0;  // of the runs
    // Of each run: the median time of a step in units of the reference kernel, timed around it. > 0.
    std::vector<double> relativeTimes;
    std::string hash;
    std::optional<double> accuracy;  // null: not finite
    int accuracyRuns = 1;            // whose median it is
    int nonFinite = 0;               // bodies
    int steps = 0;
    nlohmann::ordered_json settings;
};

struct SavedRuns {
    std::string file;  // as it was named
    std::string date, commit, cpu, compiler;
    int lanes = 0, cores = 0, kernel = 0;
    std::vector<SavedRun> runs;

    const SavedRun* Find(const std::string& scene, int threads) const;
};

// The document: FileHead, version of the reference kernel and units, without runs. Numbers that are not finite become
// null when it is written.
nlohmann::ordered_json NewDocument();

// Errors OutOfRange: the message names the file and what is wrong with it.
Result<SavedRuns> ParseSavedRuns(const nlohmann::ordered_json& document, const std::string& file);
Result<SavedRuns> ReadSavedRuns(const std::filesystem::path& file);
Status WriteSavedRuns(const nlohmann::ordered_json& document, const std::filesystem::path& file);

}  // namespace fulcrum
