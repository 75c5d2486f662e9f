#include <Fulcrum/PerformanceTest/Accuracy/RunRecord.h>

#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fulcrum::accuracy {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTimedRuns = 5;
constexpr double kQuickTimingLimit = 0.1, kFullTimingLimit = 10;  // s, of all runs of one setting

// What is not finite counts as larger than all else.
double Median(std::vector<double> values) {
    if (values.empty()) return kNaN;
    std::sort(values.begin(), values.end(), [](double a, double b) {
        const bool isFiniteA = std::isfinite(a), isFiniteB = std::isfinite(b);
        return isFiniteA && isFiniteB ? a < b : isFiniteA && !isFiniteB;
    });
    const size_t middle = values.size() / 2;
    return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

// Place by place; runs of one scene give the same names.
std::vector<NamedValue> MediansOf(const std::vector<LabRun>& runs, std::vector<NamedValue> LabRun::*list) {
    std::vector<NamedValue> medians = runs[0].*list;
    for (size_t i = 0; i < medians.size(); ++i) {
        std::vector<double> values;
        for (const LabRun& run : runs)
            if (i < (run.*list).size()) values.push_back((run.*list)[i].value);
        medians[i].value = Median(std::move(values));
    }
    return medians;
}

LabRun RunOnce(const LabScene& scene, const Setting& setting, bool isQuick, uint64_t seed, JobSystem* jobs = nullptr) {
    LabRun run(setting, scene.parameter, isQuick, seed, jobs);
    scene.run(run);
    if (setting.peer && run.work.simulatedSeconds == 0) throw NotInPeer("checks of input without a step");
    if (run.isLost) {
        for (NamedValue& error : run.errors) error.value = kNaN;
        for (double& value : run.observed) value = kNaN;
    }
    return run;
}

bool HasSameResults(const LabRun& a, const LabRun& b) {
    if (a.work.hash != b.work.hash || a.errors.size() != b.errors.size()) return false;
    for (size_t i = 0; i < a.errors.size(); ++i)
        if (a.errors[i].value != b.errors[i].value && !(std::isnan(a.errors[i].value) && std::isnan(b.errors[i].value)))
            return false;
    return true;
}

Json NumberJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
double NumberOf(const Json& json) { return json.is_null() ? kNaN : json.get<double>(); }

Json ListJson(const std::vector<NamedValue>& list) {
    Json object = Json::object();
    for (const NamedValue& each : list) object[each.name] = NumberJson(each.value);
    return object;
}
std::vector<NamedValue> ListOf(const Json& object) {
    std::vector<NamedValue> list;
    for (const auto& [name, value] : object.items()) list.push_back({name, NumberOf(value)});
    return list;
}

}  // namespace

namespace {

void MeasureRuns(const LabScene& scene, bool isQuick, bool isTimedOnce, RunRecord& record) {
    const Setting& setting = record.setting;
    record.seeds = isQuick ? scene.quickSeeds : scene.seeds;
    std::vector<LabRun> runs;
    std::vector<double> microseconds;
    double spent = 0;
    const auto time = [&](const Work& work) {
        spent += work.seconds;
        microseconds.push_back(1e6 * work.seconds / std::max(work.simulatedSeconds, 1e-9));
    };
    for (int seed = 1; seed <= record.seeds; ++seed) {
        runs.push_back(RunOnce(scene, setting, isQuick, static_cast<uint64_t>(seed)));
        time(runs.back().work);
    }
    while (!isTimedOnce && static_cast<int>(microseconds.size()) < kTimedRuns &&
           spent < (isQuick ? kQuickTimingLimit : kFullTimingLimit))
        time(RunOnce(scene, setting, isQuick, 1).work);

    // At the presets, in short grids at the default: the bits are those of two threads, too.
    const std::string preset = setting.Preset();
    if (scene.isExtreme && !setting.peer && (isQuick ? preset == "balanced" : !preset.empty())) {
        ThreadPool pool(2);
        runs[0].Require(HasSameResults(runs[0], RunOnce(scene, setting, isQuick, 1, &pool)),
                        "the same results with 1 and 2 threads");
    }

    record.errors = MediansOf(runs, &LabRun::errors);
    record.figures = MediansOf(runs, &LabRun::figures);
    record.observed = runs[0].observed;
    for (size_t i = 0; i < record.observed.size(); ++i) {
        std::vector<double> values;
        for (const LabRun& run : runs)
            if (i < run.observed.size()) values.push_back(run.observed[i]);
        record.observed[i] = Median(std::move(values));
    }
    double simulated = 0;
    for (const LabRun& run : runs) {
        for (const std::string& condition : run.failedConditions)
            if (std::find(record.failedConditions.begin(), record.failedConditions.end(), condition) ==
                record.failedConditions.end())
                record.failedConditions.push_back(condition);
        record.hash = record.hash * 31 + run.work.hash;
        record.traversals += run.work.traversals;
        simulated += run.work.simulatedSeconds;
    }
    record.traversals = setting.peer ? kNaN : record.traversals / std::max(simulated, 1e-9);
    record.effortReturns = runs[0].work.effortReturns;
    record.worst = runs[0].worst;
    record.isMeasured = runs[0].isMeasured;
    record.timedRuns = static_cast<int>(microseconds.size());
    record.microseconds = Median(std::move(microseconds));
    record.blewUp = !(record.Error() <= scene.blowUp);
}

}  // namespace

RunRecord Measure(const LabScene& scene, const Setting& setting, bool isQuick, bool isTimedOnce) {
    RunRecord record;
    record.scene = scene.FullName();
    record.setting = setting;
    try {
        MeasureRuns(scene, isQuick, isTimedOnce, record);
    } catch (const NotInPeer& lacking) {
        record.unsupported = lacking.what();
    }
    return record;
}

Json ToJson(const RunRecord& record) {
    const Setting& setting = record.setting;
    Json json;
    json["scene"] = record.scene;
    json["setting"] = setting.Key();
    json["family"] = setting.FamilyText();
    if (setting.peer) json["engine"] = setting.peer->Label();
    json["rate"] = setting.rate;
    json["substeps"] = setting.solver.substeps;
    json["velocity_iterations"] = setting.solver.velocityIterations;
    json["position_iterations"] = setting.solver.positionIterations;
    if (setting.family == Family::Target) json["target"] = setting.target;
    json["preset"] = setting.Preset();
    json["errors"] = ListJson(record.errors);
    json["self_error"] = NumberJson(record.selfError);
    json["blew_up"] = record.blewUp;
    json["failed_conditions"] = record.failedConditions;
    json["figures"] = ListJson(record.figures);
    json["observed"] = Json::array();
    for (const double value : record.observed) json["observed"].push_back(NumberJson(value));
    json["seeds"] = record.seeds;
    json["hash"] = record.hash;
    json["traversals_per_second"] = NumberJson(record.traversals);
    json["effort_returns"] = record.effortReturns;
    json["us_per_second"] = NumberJson(record.microseconds);
    json["cost_ratio"] = NumberJson(record.costRatio);
    json["timed_runs"] = record.timedRuns;
    if (!record.unsupported.empty()) json["unsupported"] = record.unsupported;
    if (!record.worst.empty()) json["worst"] = record.worst;
    if (!record.isMeasured) json["is_measured"] = false;
    if (!record.recording.empty()) json["recording"] = record.recording;
    return json;
}

Result<RunRecord> RecordFromJson(const Json& json) {
    try {
        RunRecord record;
        record.scene = json.at("scene").get<std::string>();
        const std::string family = json.at("family").get<std::string>();
        int kind = 0;
        while (kind < kFamilies && family != FamilyName(static_cast<Family>(kind))) ++kind;
        if (kind == kFamilies) {
            const Result<const Peer*> peer = FindPeer(family, "accuracy");
            if (!peer && peer.GetError().code == ErrorCode::Unsupported) return peer.GetError();
            if (!peer) return Error{ErrorCode::OutOfRange, "there is no family '" + family + "'"};
            record.setting.peer = peer.Value();
        }
        record.setting.family = static_cast<Family>(kind);
        record.setting.rate = json.at("rate").get<int>();
        SolverSettings& solver = record.setting.solver;
        solver.substeps = json.at("substeps").get<int>();
        solver.velocityIterations = json.at("velocity_iterations").get<int>();
        solver.positionIterations = json.at("position_iterations").get<int>();
        if (record.setting.family == Family::Baumgarte) solver.positionCorrection = PositionCorrection::Baumgarte;
        if (record.setting.family == Family::Target) record.setting.target = json.at("target").get<float>();
        record.errors = ListOf(json.at("errors"));
        record.figures = ListOf(json.at("figures"));
        for (const Json& value : json.at("observed")) record.observed.push_back(NumberOf(value));
        record.failedConditions = json.at("failed_conditions").get<std::vector<std::string>>();
        record.unsupported = json.value("unsupported", "");
        record.worst = json.value("worst", "");
        record.isMeasured = json.value("is_measured", true);
        record.blewUp = json.at("blew_up").get<bool>();
        record.seeds = json.at("seeds").get<int>();
        record.hash = json.at("hash").get<uint64_t>();
        record.traversals = NumberOf(json.at("traversals_per_second"));
        record.effortReturns = json.at("effort_returns").get<int>();
        record.microseconds = NumberOf(json.at("us_per_second"));
        record.timedRuns = json.at("timed_runs").get<int>();
        return record;
    } catch (const nlohmann::json::exception& error) {
        return Error{ErrorCode::OutOfRange, std::string("no run of the lab: ") + error.what()};
    }
}

void AddSelfErrors(std::vector<RunRecord>& ofScene) {
    const RunRecord *ours = nullptr, *peers = nullptr;  // the finest
    for (const RunRecord& run : ofScene) {
        if ((run.setting.family != Family::Soft && !run.setting.peer) || run.blewUp) continue;
        const auto fineness = [](const RunRecord& r) { return std::pair(r.setting.PassesPerSecond(), r.setting.rate); };
        const RunRecord*& finest = run.setting.peer ? peers : ours;
        if (!finest || fineness(run) > fineness(*finest)) finest = &run;
    }
    for (RunRecord& run : ofScene) {
        const RunRecord* finest = run.setting.peer ? peers : ours;
        run.selfError = kNaN;
        if (!finest || run.observed.size() != finest->observed.size()) continue;
        double largest = 0;
        for (size_t i = 0; i < run.observed.size(); ++i) {
            const double off = std::abs(run.observed[i] - finest->observed[i]);
            largest = off <= largest ? largest : off;  // NaN stays
        }
        run.selfError = largest;
    }
}

void AddCostRatios(std::vector<RunRecord>& ofScene) {
    double usual = kNaN;
    for (const RunRecord& run : ofScene)
        if (run.setting == Setting{}) usual = run.microseconds;
    for (RunRecord& run : ofScene) run.costRatio = usual > 0 ? run.microseconds / usual : kNaN;
}

}  // namespace fulcrum::accuracy
