// Runs scenes over a grid of settings, several runs at a time, and appends each finished run to a file, so that an
// interrupted lab can be resumed. Called by Main.cpp and the tests; starts threads of its own.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <filesystem>
#include <vector>

namespace fulcrum::accuracy {

struct LabOptions {
    std::vector<const LabScene*> scenes;
    std::vector<Setting> settings;  // in place of the grid; empty: the grid
    bool isQuick = false;
    bool comparesTargets = false;  // the grid is TargetGrid
    bool advises = false;          // the grid is AdviceGrid
    const Peer* peer = nullptr;    // another engine that runs PeerGrid besides the grid; null: none
    bool isTimedOnce = false;      // else costs are medians of five runs, unless that takes too long
    int threads = 1;               // runs at a time; the engine of each has one thread
    bool resumes = false;
    std::filesystem::path folder;  // runs.jsonl is in it; created
    bool showsProgress = true;     // on stderr
};

// All runs, sorted by scene and setting, those of another engine last, with their self errors. When resuming, the
// complete lines of runs.jsonl are kept and only missing runs are made; otherwise an existing file is renamed to
// runs.jsonl.bak. Errors OutOfRange: the folder cannot be written; the file is of another grid or another version.
Result<std::vector<RunRecord>> RunLab(const LabOptions& options);

}  // namespace fulcrum::accuracy
