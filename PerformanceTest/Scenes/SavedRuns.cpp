#include <Fulcrum/PerformanceTest/Scenes/SavedRuns.h>

#include <Fulcrum/PerformanceTest/Scenes/ReferenceKernel.h>
#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>

#include <cmath>

namespace fulcrum {
namespace {

using Json = nlohmann::ordered_json;

Error Wrong(const std::string& file, const std::string& what) { return {ErrorCode::OutOfRange, file + ": " + what}; }

// Throws nlohmann's exceptions where something is missing or of another type.
SavedRun ParseRun(const Json& json) {
    SavedRun run;
    run.scene = json.at("scene").get<std::string>();
    run.threads = json.at("threads").get<int>();
    const auto ms = json.at("run_ms").get<std::vector<double>>();
    if (!ms.empty()) run.medianMs = MedianOf(ms);
    run.relativeTimes = json.at("relative_times").get<std::vector<double>>();
    run.hash = json.at("hash").get<std::string>();
    if (!json.at("accuracy").is_null()) run.accuracy = json.at("accuracy").get<double>();
    if (json.contains("accuracy_of_runs")) run.accuracyRuns = static_cast<int>(json["accuracy_of_runs"].size());
    run.nonFinite = json.at("nonfinite").get<int>();
    run.steps = json.at("steps").get<int>();
    run.settings = json.at("settings");
    return run;
}

std::string WhatIsWrongWith(const SavedRun& run) {
    if (run.threads < 1) return "its threads are fewer than 1";
    if (run.relativeTimes.empty()) return "relative_times has no number";
    for (double time : run.relativeTimes)
        if (!(std::isfinite(time) && time > 0)) return "relative_times has a number that is not above 0";
    return {};
}

std::string TextOf(const Json& json, const char* name) {
    const Json& value = json.at(name);
    return value.is_null() ? "unknown" : value.get<std::string>();
}

}  // namespace

const SavedRun* SavedRuns::Find(const std::string& scene, int threads) const {
    for (const SavedRun& run : runs)
        if (run.scene == scene && run.threads == threads) return &run;
    return nullptr;
}

Json NewDocument() {
    Json document = FileHead("fulcrum-bench");
    document["kernel"] = kReferenceKernelVersion;
    document["units"] = {{"*_ms", "milliseconds of wall clock"},
                         {"relative_times", "median_ms of a run in units of the reference kernel around it"},
                         {"*_m", "meters"},
                         {"*_m_s", "meters a second"},
                         {"*_j", "joules"},
                         {"*_s", "seconds"},
                         {"accuracy", "what ./fulcrum run says of the scene"}};
    return document;
}

Result<SavedRuns> ParseSavedRuns(const Json& document, const std::string& file) {
    if (document.is_array() || !document.is_object() || !document.contains("schema"))
        return Wrong(file,
                     "has no schema number, so it was not saved by `bench --save`, or by an older version; save it "
                     "anew");
    const Json& schema = document["schema"];
    if (schema != kFileSchema)
        return Wrong(file, "has schema " + schema.dump() + ", this version reads " + std::to_string(kFileSchema) +
                               "; save it anew with `bench --save`");
    SavedRuns saved;
    saved.file = file;
    std::string place = "the head";
    try {
        saved.date = TextOf(document, "date");
        saved.commit = TextOf(document, "commit");
        saved.compiler = TextOf(document, "compiler");
        saved.lanes = document.at("lanes").get<int>();
        saved.kernel = document.at("kernel").get<int>();
        saved.cpu = TextOf(document.at("machine"), "cpu");
        saved.cores = document.at("machine").at("cores").get<int>();
        for (const Json& run : document.at("runs")) {
            place = "run " + std::to_string(saved.runs.size() + 1);
            saved.runs.push_back(ParseRun(run));
            const std::string wrong = WhatIsWrongWith(saved.runs.back());
            if (!wrong.empty()) return Wrong(file, "is damaged: in " + place + " " + wrong);
        }
    } catch (const Json::exception& exception) {
        return Wrong(file, "is damaged: in " + place + " " + exception.what());
    }
    if (saved.kernel != kReferenceKernelVersion)
        return Wrong(file, "was timed against version " + std::to_string(saved.kernel) +
                               " of the reference kernel, this is version " + std::to_string(kReferenceKernelVersion) +
                               "; save it anew with `bench --save`");
    return saved;
}

Result<SavedRuns> ReadSavedRuns(const std::filesystem::path& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return Wrong(file.string(), "there is no such file");
    const Result<std::string> text = ReadWholeFile(file);
    if (!text) return text.GetError();
    Json document;
    try {
        document = Json::parse(text.Value());
    } catch (const Json::exception& exception) {
        return Wrong(file.string(), std::string("is damaged: ") + exception.what());
    }
    return ParseSavedRuns(document, file.string());
}

Status WriteSavedRuns(const Json& document, const std::filesystem::path& file) {
    return WriteWholeFile(file, {document.dump(2), "\n"});
}

}  // namespace fulcrum
