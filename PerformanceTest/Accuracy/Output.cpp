#include <Fulcrum/PerformanceTest/Accuracy/Output.h>

#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fulcrum::accuracy {
namespace {

using Json = nlohmann::ordered_json;

// Empty where it cannot be read.
std::string ContentOf(const std::filesystem::path& path) {
    Result<std::string> read = ReadWholeFile(path);
    return read ? std::move(read.Value()) : std::string();
}

std::string Number(double value) {
    if (!std::isfinite(value)) return "";
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
}

Json NumberJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

std::string Joined(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += (text.empty() ? "" : "; ") + part;
    return text;
}

// Ours, then the other engine's.
std::vector<RunRecord> AllOf(const SceneRuns& scene) {
    std::vector<RunRecord> all = scene.runs;
    all.insert(all.end(), scene.peerRuns.begin(), scene.peerRuns.end());
    return all;
}

Json SummaryOf(std::span<const RunRecord> runs) {
    Json summary;
    summary["slope"] = NumberJson(SlopeOverDt(runs));
    summary["floor"] = NumberJson(Floor(runs));
    for (const auto& [name, error] :
         {std::pair("us_for_10_percent", 0.1), {"us_for_1_percent", 0.01}, {"us_for_0.1_percent", 0.001}}) {
        const RunRecord* run = CheapestFor(runs, error);
        summary[name] = run ? NumberJson(run->microseconds) : Json(nullptr);
    }
    Json envelope = Json::array();
    for (const size_t i : Envelope(runs)) envelope.push_back(i);
    summary["envelope"] = envelope;
    return summary;
}

}  // namespace

std::vector<SceneRuns> ByScene(std::vector<RunRecord> runs) {
    std::vector<SceneRuns> scenes;
    for (RunRecord& run : runs) {
        if (scenes.empty() || scenes.back().scene->FullName() != run.scene)
            scenes.push_back({FindLabScenes(run.scene)[0], {}});
        SceneRuns& scene = scenes.back();
        if (!run.unsupported.empty()) scene.peerLacks = run.unsupported;
        else (run.setting.peer ? scene.peerRuns : scene.runs).push_back(std::move(run));
    }
    return scenes;
}

std::string CsvOf(std::span<const SceneRuns> scenes) {
    std::string csv =
        "scene,family,rate_hz,dt_s,substeps,velocity_iterations,position_iterations,preset,error,self_error,blew_up,"
        "us_per_second,timed_runs,traversals_per_second,seeds,errors,figures,failed_conditions\n";
    const auto named = [](const std::vector<NamedValue>& list) {
        std::vector<std::string> parts;
        for (const NamedValue& each : list) parts.push_back(each.name + "=" + Number(each.value));
        return "\"" + Joined(parts) + "\"";
    };
    for (const SceneRuns& scene : scenes)
        for (const RunRecord& run : AllOf(scene)) {
            const Setting& setting = run.setting;
            std::string line;
            for (const std::string& cell :
                 {run.scene, std::string(setting.FamilyText()), std::to_string(setting.rate), Number(setting.Dt()),
                  std::to_string(setting.solver.substeps), std::to_string(setting.solver.velocityIterations),
                  std::to_string(setting.solver.positionIterations), std::string(setting.Preset()), Number(run.Error()),
                  Number(run.selfError), std::string(run.blewUp ? "1" : "0"), Number(run.microseconds),
                  std::to_string(run.timedRuns), Number(run.traversals), std::to_string(run.seeds), named(run.errors),
                  named(run.figures), "\"" + Joined(run.failedConditions) + "\""})
                line += (line.empty() ? "" : ",") + cell;
            csv += line + "\n";
        }
    return csv;
}

Json JsonOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances) {
    Json json;
    json["schema"] = kSchemaVersion;
    json["machine"] = CpuModel() + ", " + std::to_string(CoreCount()) + " threads";
    json["compiler"] = CompilerName();
    json["lanes"] = kLanes;
    json["commit"] = circumstances.commit.empty() ? Json(nullptr) : Json(circumstances.commit);
    json["date"] = UtcNow();
    json["quick"] = circumstances.isQuick;
    json["runs_at_a_time"] = circumstances.threads;
    const Peer* peer = circumstances.peer;
    json["peer"] = peer ? Json{{"family", peer->name}, {"engine", peer->Label()}} : Json(nullptr);
    json["peers"] = Json::parse(ContentOf(FULCRUM_ACCURACY_PEERS), nullptr, false);
    json["scenes"] = Json::array();
    for (const SceneRuns& each : scenes) {
        const LabScene& scene = *each.scene;
        Json object;
        object["name"] = scene.FullName();
        object["what"] = scene.what;
        object["error"] = scene.error;
        object["is_extreme"] = scene.isExtreme;
        object["blow_up"] = scene.blowUp;
        object["summary"] = SummaryOf(each.runs);
        object["runs"] = Json::array();
        for (const RunRecord& run : AllOf(each)) object["runs"].push_back(ToJson(run));
        if (!each.peerLacks.empty()) object["peer_lacks"] = each.peerLacks;
        json["scenes"].push_back(std::move(object));
    }
    return json;
}

Status WriteReport(const Json& runs, const std::filesystem::path& path) {
    constexpr std::string_view kPlaceOfRuns = "@@FULCRUM_RUNS@@";
    const std::string page = ContentOf(FULCRUM_ACCURACY_PAGE);
    const size_t place = page.find(kPlaceOfRuns);
    if (place == std::string::npos)
        return Error{ErrorCode::OutOfRange,
                     "the page " FULCRUM_ACCURACY_PAGE " is missing or damaged: build fulcrum-accuracy"};
    std::string data;
    for (const char c : runs.dump()) data += c == '<' ? std::string("\\u003c") : std::string(1, c);  // ends no script
    const std::string_view whole = page;
    return WriteWholeFile(path, {whole.substr(0, place), data, whole.substr(place + kPlaceOfRuns.size())},
                          MissingFolders::AreCreated);
}

}  // namespace fulcrum::accuracy
