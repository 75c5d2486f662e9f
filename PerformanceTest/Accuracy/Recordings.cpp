#include <Fulcrum/PerformanceTest/Accuracy/Recordings.h>

#include <Fulcrum/PerformanceTest/Accuracy/LabRecorder.h>
#include <Fulcrum/PerformanceTest/Accuracy/Output.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/Samples/Runner/Progress.h>
#include <Fulcrum/Samples/Viewer/HtmlWriter.h>

#include <algorithm>
#include <optional>

namespace fulcrum::accuracy {
namespace {

void Describe(const RunRecord& run, const LabScene& scene, Recording& recording) {
    recording.title = scene.FullName();
    recording.description = std::string(scene.what) + "; " + run.setting.Key();
    for (const NamedValue& error : run.errors)
        recording.report.push_back({"Errors", error.name, ShortNumber(error.value)});
    for (const std::string& condition : run.failedConditions) recording.report.push_back({"Fails", condition, ""});
    recording.report.push_back({"Cost", "work a second", ShortNumber(run.microseconds) + " us"});
    recording.report.push_back({"Cost", "traversals a second", ShortNumber(run.traversals)});
}

Status WriteRecording(const RunRecord& run, bool isQuick, const std::filesystem::path& path) {
    const LabScene& scene = *FindLabScenes(run.scene)[0];
    LabRecorder recorder;
    LabRun repeated(run.setting, scene.parameter, isQuick, 1);
    repeated.recorder = &recorder;
    scene.run(repeated);
    Describe(run, scene, recorder.recording);
    return WriteHtml(recorder.recording, path);
}

}  // namespace

std::string RecordingPath(const RunRecord& run) {
    std::string name = run.scene + "_" + run.setting.Key();
    std::ranges::replace(name, ' ', '_');
    std::ranges::replace(name, '/', '-');
    return "recordings/" + name + ".html";
}

Status WriteRecordings(std::span<const RunRecord> runs, const RecordingOptions& options,
                       const std::filesystem::path& folder) {
    std::vector<const RunRecord*> wanted;
    std::string keys;
    for (const RunRecord& run : runs) {
        if (!run.unsupported.empty()) continue;
        if (options.isOfAll || run.setting.Key() == options.setting) wanted.push_back(&run);
        if (run.scene == runs.front().scene) keys += (keys.empty() ? "'" : "', '") + run.setting.Key();
    }
    if (wanted.empty())
        return Error{ErrorCode::OutOfRange,
                     "no run has the setting '" + options.setting + "'; there are " + keys + "'"};
    std::error_code ignored;
    std::filesystem::create_directories(folder / "recordings", ignored);
    std::optional<Progress> progress;
    if (options.showsProgress) progress.emplace("recordings", static_cast<int>(wanted.size()));
    for (const RunRecord* run : wanted) {
        if (const Status written = WriteRecording(*run, options.isQuick, folder / RecordingPath(*run)); !written)
            return written;
        if (progress) progress->Advance();
    }
    return Done{};
}

void FindRecordings(std::span<RunRecord> runs, const std::filesystem::path& folder) {
    for (RunRecord& run : runs) {
        const std::string path = RecordingPath(run);
        std::error_code ignored;
        run.recording = std::filesystem::exists(folder / path, ignored) ? path : "";
    }
}

}  // namespace fulcrum::accuracy
