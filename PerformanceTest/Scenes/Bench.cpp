#include <Fulcrum/PerformanceTest/Scenes/Bench.h>

#include <Fulcrum/PerformanceTest/Scenes/BenchTables.h>
#include <Fulcrum/PerformanceTest/Scenes/Comparison.h>
#include <Fulcrum/PerformanceTest/Scenes/History.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Runner/JsonOutput.h>
#include <Fulcrum/Samples/Runner/Progress.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <algorithm>
#include <cstdio>

namespace fulcrum {
namespace {

int Fail(const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s\n", message.c_str());
    return 2;
}

int PrintHistory(const BenchOptions& options) {
    std::vector<SavedRuns> saved;
    for (const std::string& file : options.history) {
        Result<SavedRuns> runs = ReadSavedRuns(file);
        if (!runs) return Fail(runs.GetError().message);
        saved.push_back(std::move(runs.Value()));
    }
    std::vector<std::string> names;
    for (const Scene* scene : options.scenes) names.push_back(scene->name);
    std::printf("%s", HistoryText(std::move(saved), names).c_str());
    return 0;
}

// The scenes and threads that the options leave to the baseline.
void CompleteFrom(const SavedRuns& baseline, BenchOptions& options) {
    const bool areScenesGiven = !options.scenes.empty(), areThreadsGiven = !options.threads.empty();
    for (const SavedRun& run : baseline.runs) {
        const Scene* scene = FindScene(run.scene);
        if (!areScenesGiven && scene &&
            std::find(options.scenes.begin(), options.scenes.end(), scene) == options.scenes.end())
            options.scenes.push_back(scene);
        if (!areThreadsGiven &&
            std::find(options.threads.begin(), options.threads.end(), run.threads) == options.threads.end())
            options.threads.push_back(run.threads);
    }
}

void CompleteWithDefaults(BenchOptions& options) {
    if (options.threads.empty()) options.threads = {1};
    if (!options.scenes.empty()) return;
    for (const Scene* scene : AllScenes())
        if (scene->kind == SceneKind::Performance) options.scenes.push_back(scene);
}

std::optional<double> AccuracyToleranceOf(const std::string& name) {
    const Scene* scene = FindScene(name);
    return scene ? scene->accuracyTolerance : std::nullopt;
}

// All timed scenes of a call, those of one scene next to each other.
class Bench {
public:
    explicit Bench(const BenchOptions& options)
        : options_(options), peer_(options.peer), peerRuns_(options.scenes.size()) {
        for (const Scene* scene : options.scenes)
            for (int threads : options.threads)
                timed_.push_back(std::make_unique<TimedScene>(*scene, threads, options));
    }

    // Rounds over all scenes, so that a temporary disturbance of the machine affects one run of each, not all runs of
    // one.
    Status Run() {
        std::optional<Progress> progress;
        if (options_.runs > 1 && !options_.quiet)
            progress.emplace("Timing", options_.runs * static_cast<int>(timed_.size()));
        else if (!options_.quiet) PrintTimesHeading(peer_);
        for (int round = 0; round < options_.runs; ++round)
            for (size_t i = 0; i < timed_.size(); ++i) {
                if (peer_ && IsFirstOfScene(i)) timed_[i]->RunPeer(*peer_, PeerRunsOf(i));
                const Status status = timed_[i]->Run(kernel_);
                if (!status) return Named(*timed_[i], status);
                if (round + 1 == options_.runs && options_.accuracyRuns) {
                    const Status accuracy = AddAccuracyRuns(i);
                    if (!accuracy) return Named(*timed_[i], accuracy);
                }
                if (progress) progress->Advance();
                else if (!options_.quiet) PrintTimes(*timed_[i], peer_, PeerRunsOf(i));
            }
        return Done{};
    }

    void Print() {
        if (options_.quiet) return;
        if (options_.runs > 1) {
            PrintTimesHeading(peer_);
            for (size_t i = 0; i < timed_.size(); ++i) PrintTimes(*timed_[i], peer_, PeerRunsOf(i));
        }
        if (options_.accuracyRuns) PrintAccuracy(timed_);
    }

    nlohmann::ordered_json ToJson() {
        nlohmann::ordered_json document = NewDocument(), runs = nlohmann::ordered_json::array();
        for (size_t i = 0; i < timed_.size(); ++i)
            runs.push_back(timed_[i]->ToJson(options_.seed, peer_, PeerRunsOf(i)));
        document["runs"] = std::move(runs);
        return document;
    }

private:
    bool IsFirstOfScene(size_t i) const { return i % options_.threads.size() == 0; }
    PeerRuns& PeerRunsOf(size_t i) { return peerRuns_[i / options_.threads.size()]; }
    Status AddAccuracyRuns(size_t i) {
        if (IsFirstOfScene(i)) return timed_[i]->AddAccuracyRuns();
        timed_[i]->TakeAccuracyRuns(*timed_[i - i % options_.threads.size()]);
        return Done{};
    }
    static Status Named(const TimedScene& scene, const Status& status) {
        return Error{status.GetError().code, std::string(scene.Definition().name) + ": " + status.GetError().message};
    }

    const BenchOptions& options_;
    const Peer* peer_;  // null: none
    ReferenceKernel kernel_;
    std::vector<std::unique_ptr<TimedScene>> timed_;
    std::vector<PeerRuns> peerRuns_;  // by scene
};

// Before anything is timed for minutes.
std::string WhatCannotBeWritten(const BenchOptions& options) {
    if (options.save.empty()) return {};
    const Status writable = CheckWritable(options.save);
    return writable ? "" : "--save: " + writable.GetError().message;
}

int Compare(const nlohmann::ordered_json& document, const SavedRuns& baseline, const BenchOptions& options) {
    const Result<SavedRuns> now = ParseSavedRuns(document, "this run");
    if (!now) return Fail(now.GetError().message);
    const Result<std::vector<ComparedRun>> compared =
        CompareRuns(now.Value(), baseline, options.tolerance, AccuracyToleranceOf);
    if (!compared) return Fail(compared.GetError().message);
    PrintComparison(compared.Value(), options.tolerance, options.quiet);
    if (!options.quiet)
        for (const std::string& difference : DifferencesOfMachines(now.Value(), baseline))
            std::printf("%s\n", difference.c_str());
    return ExitStatusOf(compared.Value());
}

}  // namespace

int RunBench(const BenchOptions& given) {
    if (!given.history.empty()) return PrintHistory(given);
    const JsonOutput json(given.json);
    for (const std::string& trouble : {json.Check(), WhatCannotBeWritten(given)})
        if (!trouble.empty()) return Fail(trouble);

    BenchOptions options = given;
    std::optional<SavedRuns> baseline;
    if (!options.baseline.empty()) {
        Result<SavedRuns> read = ReadSavedRuns(options.baseline);
        if (!read) return Fail(read.GetError().message);
        baseline = std::move(read.Value());
        CompleteFrom(*baseline, options);
    }
    CompleteWithDefaults(options);
    if (baseline)
        for (const Scene* scene : options.scenes)
            for (int threads : options.threads)
                if (const MaybeError error = CheckComparable(*baseline, scene->name, threads))
                    return Fail(error->message);

    Bench bench(options);
    const Status status = bench.Run();
    if (!status) return Fail(status.GetError().message);
    bench.Print();
    const nlohmann::ordered_json document = bench.ToJson();
    if (json.IsWanted()) {
        const std::string unwritten = json.Write(document);
        if (!unwritten.empty()) return Fail(unwritten);
    }
    if (!options.save.empty()) {
        const Status written = WriteSavedRuns(document, options.save);
        if (!written) return Fail(written.GetError().message);
        if (!options.quiet) std::printf("Wrote %s\n", options.save.c_str());
    }
    return baseline ? Compare(document, *baseline, options) : 0;
}

}  // namespace fulcrum
