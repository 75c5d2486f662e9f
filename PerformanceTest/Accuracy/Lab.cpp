#include <Fulcrum/PerformanceTest/Accuracy/Lab.h>

#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Runner/Progress.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

namespace fulcrum::accuracy {
namespace {

using Json = nlohmann::ordered_json;

struct PlannedRun {
    const LabScene* scene;
    Setting setting;
    int weight;  // of its time, for the progress
};

std::vector<PlannedRun> Plan(const LabOptions& options) {
    std::vector<PlannedRun> plan;
    for (const LabScene* scene : options.scenes) {
        auto grid = !options.settings.empty() ? options.settings
                    : options.comparesTargets ? TargetGrid(scene->influences)
                    : options.advises         ? AdviceGrid(scene->influences)
                    : options.isQuick         ? QuickGrid(scene->influences)
                                              : FullGrid(scene->influences, scene->isSlow);
        if (options.peer) {
            const auto more = PeerGrid(scene->influences, *options.peer, options.isQuick);
            grid.insert(grid.end(), more.begin(), more.end());
        }
        for (const Setting& setting : grid)
            plan.push_back(
                {scene, setting, 1 + static_cast<int>((10.0 * setting.rate + setting.PassesPerSecond()) / 1000)});
    }
    return plan;
}

std::string HeaderLine(bool isQuick) { return Json{{"fulcrum_accuracy", kSchemaVersion}, {"quick", isQuick}}.dump(); }

using Key = std::pair<std::string, std::string>;
Key KeyOf(const RunRecord& record) { return {record.scene, record.setting.Key()}; }

// The file that runs are appended to, a line each, the first one saying of which grid they are.
class RunLog {
public:
    explicit RunLog(const LabOptions& options)
        : path_(options.folder / "runs.jsonl"), header_(HeaderLine(options.isQuick)) {}

    // Takes over the complete lines of the file, and cuts off what follows them.
    Status Resume(std::map<Key, RunRecord>& runs) {
        std::error_code error;
        if (!std::filesystem::exists(path_, error)) return Begin();
        const Result<std::string> read = ReadWholeFile(path_);
        if (!read) return read.GetError();
        const std::string& text = read.Value();
        size_t complete = 0;  // bytes
        for (size_t end; (end = text.find('\n', complete)) != std::string::npos; complete = end + 1) {
            const std::string line = text.substr(complete, end - complete);
            if (complete == 0) {
                if (line == header_) continue;
                return Error{ErrorCode::OutOfRange, path_.string() + " is of another grid or version: '" + line +
                                                        "', not '" + header_ +
                                                        "'; name another folder, or leave out --resume"};
            }
            const Json json = Json::parse(line, nullptr, false);
            if (json.is_discarded()) break;
            Result<RunRecord> record = RecordFromJson(json);
            if (!record && record.GetError().code == ErrorCode::Unsupported) continue;
            if (!record) break;
            runs[KeyOf(record.Value())] = std::move(record.Value());
        }
        if (complete == 0) return Begin();
        std::filesystem::resize_file(path_, complete, error);
        if (error) return Error{ErrorCode::OutOfRange, path_.string() + ": " + error.message()};
        return Open(std::ios::app);
    }
    Status Begin() {
        std::error_code ignored;
        std::filesystem::create_directories(path_.parent_path(), ignored);
        if (std::filesystem::exists(path_, ignored))
            std::filesystem::rename(path_, std::filesystem::path(path_) += ".bak", ignored);
        if (Status status = Open(std::ios::trunc); !status) return status;
        return Write(header_ + "\n");
    }
    Status Append(const RunRecord& record) { return Write(ToJson(record).dump() + "\n"); }

private:
    Status Open(std::ios::openmode mode) {
        file_.open(path_, std::ios::binary | std::ios::out | mode);
        if (!file_) return Error{ErrorCode::OutOfRange, "cannot write " + path_.string()};
        return Done{};
    }
    Status Write(const std::string& text) {
        file_ << text << std::flush;
        if (!file_) return Error{ErrorCode::OutOfRange, "cannot write " + path_.string()};
        return Done{};
    }

    std::filesystem::path path_;
    std::string header_;
    std::ofstream file_;
};

// Makes the runs on so many threads. Each run is alone in its thread, so that neither their number nor their order
// changes a result. Ends soon where the log cannot be written, as on a full disk.
Status MakeRuns(const std::vector<PlannedRun>& plan, const LabOptions& options, RunLog& log,
                std::map<Key, RunRecord>& runs) {
    int total = 0;
    for (const PlannedRun& each : plan) total += each.weight;
    std::optional<Progress> progress;
    if (options.showsProgress) progress.emplace("accuracy", total, ProgressShows::TimeLeft);
    std::atomic<size_t> next{0};
    Status written = Done{};
    std::mutex mutex, ofPeer;  // Bullet is not made for several threads, even of several worlds
    const auto work = [&] {
        for (size_t i; (i = next++) < plan.size();) {
            std::unique_lock<std::mutex> alone;
            if (plan[i].setting.peer) alone = std::unique_lock(ofPeer);
            RunRecord record = Measure(*plan[i].scene, plan[i].setting, options.isQuick, options.isTimedOnce);
            const std::lock_guard lock(mutex);
            if (Status status = log.Append(record); !status) {
                written = status;
                next = plan.size();
            }
            runs[KeyOf(record)] = std::move(record);
            if (progress) progress->Advance(plan[i].weight);
        }
    };
    std::vector<std::thread> threads;
    for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
    work();
    for (std::thread& thread : threads) thread.join();
    return written;
}

}  // namespace

Result<std::vector<RunRecord>> RunLab(const LabOptions& options) {
    RunLog log(options);
    std::map<Key, RunRecord> runs;
    const Status opened = options.resumes ? log.Resume(runs) : log.Begin();
    if (!opened) return opened.GetError();

    const std::vector<PlannedRun> plan = Plan(options);
    std::vector<PlannedRun> missing;
    for (const PlannedRun& each : plan)
        if (!runs.contains({each.scene->FullName(), each.setting.Key()})) missing.push_back(each);
    // Cheap settings of all scenes first: what an interrupted day leaves are whole curves, and the time left is known
    // soon.
    std::stable_sort(missing.begin(), missing.end(),
                     [](const PlannedRun& a, const PlannedRun& b) { return a.weight < b.weight; });
    if (!missing.empty())
        if (const Status made = MakeRuns(missing, options, log, runs); !made) return made.GetError();

    std::vector<RunRecord> sorted;
    for (const LabScene* scene : options.scenes) {
        std::vector<RunRecord> ofScene;
        for (const PlannedRun& each : plan)
            if (each.scene == scene) ofScene.push_back(runs.at({scene->FullName(), each.setting.Key()}));
        AddSelfErrors(ofScene);
        AddCostRatios(ofScene);
        for (RunRecord& record : ofScene) sorted.push_back(std::move(record));
    }
    return sorted;
}

}  // namespace fulcrum::accuracy
