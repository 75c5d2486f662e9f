#include <Fulcrum/Samples/Runner/RunReport.h>

#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>
#include <Fulcrum/Version.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace fulcrum {
namespace {

[[gnu::format(printf, 1, 2)]] std::string Text(const char* format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return text;
}

std::string Bytes(size_t bytes) {
    const double megabytes = static_cast<double>(bytes) / (1024 * 1024);
    return megabytes < 1 ? Text("%.0f KB", 1024 * megabytes) : Text("%.1f MB", megabytes);
}

std::string Energy(double joules) {
    const double size = std::fabs(joules);
    if (size >= 1e9) return Text("%.4g GJ", joules * 1e-9);
    if (size >= 1e6) return Text("%.4g MJ", joules * 1e-6);
    if (size >= 1e3) return Text("%.4g kJ", joules * 1e-3);
    return Text("%.4g J", joules);
}

std::string Settings(const SolverSettings& solver) {
    return Text("%d substeps, %d velocity and %d position iterations%s", solver.substeps, solver.velocityIterations,
                solver.positionIterations,
                solver.positionCorrection == PositionCorrection::Baumgarte ? ", Baumgarte" : "");
}

std::string Length(double meters) { return meters < 1 ? Text("%.4g mm", 1000 * meters) : Text("%.4g m", meters); }

void AddRest(const RunFigures& figures, std::vector<ReportLine>& lines) {
    const auto add = [&](const char* label, std::string value) {
        lines.push_back({"Result", label, std::move(value)});
    };
    if (figures.drift)
        add("drift sideways",
            Length(figures.drift->largest) + " at most, " + Length(figures.drift->mean) + " on average");
    if (figures.endSpeed) add("speed in the last second", Text("%.4g m/s at most", *figures.endSpeed));
    if (figures.sleep)
        add("all asleep", figures.sleep->seconds ? Text("after %.4g s", *figures.sleep->seconds)
                                                 : Text("never within %.4g s", figures.sleep->limit));
    if (figures.energyRise)
        add("energy from nothing", Energy(figures.energyRise->joules) +
                                       Text(", %.2g %% of that at the start, %s", 100 * figures.energyRise->relative,
                                            JudgementOf(figures.energyRise->relative)));
}

void AddErrors(const ErrorFigures& errors, std::vector<ReportLine>& lines) {
    const auto add = [&](const char* label, const WorstOfRun& worst, const std::string& value) {
        lines.push_back({"Errors of a step, largest", label,
                         worst.whose.empty() ? "none" : value + ", " + worst.whose + Text(" at step %d", worst.step)});
    };
    add("joint, apart", errors.jointError, Length(errors.jointError.value));
    add("joint, turned", errors.jointAngle, Text("%.4g rad", errors.jointAngle.value));
    add("energy gained by an island", errors.energyGain, Energy(errors.energyGain.value));
    add("momentum", errors.momentum, Text("%.4g N s", errors.momentum.value));
    add("angular momentum", errors.angularMomentum, Text("%.4g N m s", errors.angularMomentum.value));
    add("push", errors.push, Energy(errors.push.value));
    add("effort", errors.effort,
        Text("%.0f substeps%s", errors.effort.value, errors.solvesDirectly ? ", loads solved directly" : ""));
    lines.push_back({"Errors of a step, largest", "energy of all, all steps", Energy(errors.energyChange)});
}

// Rare events, if they happened.
void AddRemarks(const RunFigures& figures, std::vector<ReportLine>& lines) {
    const auto add = [&](const char* label, uint64_t count) {
        if (count > 0) lines.push_back({"Remarks", label, std::to_string(count)});
    };
    add("bodies frozen, not finite", static_cast<uint64_t>(figures.nonFinite));
    add("libccd: EPA contradicted itself", figures.libccdFailures);
    add("libccd: gave no axis", figures.libccdFallbacks);
    add("constraints without a color", figures.last.overflowConstraints);
    add("bodies at their speed limit", figures.last.clampedBodies);
}

}  // namespace

const char* JudgementOf(double relative) {
    if (relative <= 0.01) return "good";
    return relative <= 0.1 ? "fair" : "poor";
}

AccuracyVerdict VerdictOf(const Scene& scene, const RunFigures& figures) {
    if (!scene.accuracy || !scene.accuracyRange || figures.steps != StepsIn(scene.steps / 60.0, figures.dt))
        return AccuracyVerdict::Unknown;
    const auto& [lowest, highest] = *scene.accuracyRange;
    return figures.accuracy >= lowest && figures.accuracy <= highest ? AccuracyVerdict::Pass : AccuracyVerdict::Fail;
}

std::string AccuracyText(const Scene& scene, const RunFigures& figures) {
    const std::string unit = *scene.accuracyUnit ? std::string(" ") + scene.accuracyUnit : "";
    std::string text = Text("%.6g", figures.accuracy) + unit;
    if (!scene.accuracyRange) {
        text += ", no threshold";
    } else {
        const auto& [lowest, highest] = *scene.accuracyRange;
        const std::string range = lowest == highest ? Text("%g", lowest) : Text("%g to %g", lowest, highest);
        switch (VerdictOf(scene, figures)) {
            case AccuracyVerdict::Pass: text += ", pass: " + range + unit + " is asked for"; break;
            case AccuracyVerdict::Fail: text += ", FAIL: " + range + unit + " is asked for"; break;
            case AccuracyVerdict::Unknown:
                text += Text(", not judged: the threshold, %s%s, is for %.4g s, not %.4g s", range.c_str(),
                             unit.c_str(), scene.steps / 60.0, figures.steps * figures.dt);
        }
    }
    return text + " (" + scene.accuracyMeaning + ")";
}

std::vector<ReportLine> ReportLines(const Scene& scene, const RunFigures& figures, uint64_t seed) {
    std::vector<ReportLine> lines;
    const auto add = [&](const char* section, const char* label, std::string value) {
        lines.push_back({section, label, std::move(value)});
    };
    const StepReport& last = figures.last;
    add("World", "bodies",
        Text("%zu (%zu dynamic, %u awake)", figures.bodies, figures.dynamicBodies, last.awakeBodies));
    add("World", "contacts",
        Text("%u (%u points), at most %u", last.contacts, last.contactPoints, figures.largestContacts));
    add("World", "islands", Text("%u (%u awake)", figures.islands, figures.awakeIslands));
    add("World", "memory", Bytes(figures.memoryBytes));
    add("Run", "steps", Text("%d of %.5g s", figures.steps, figures.dt));
    add("Run", "solver", Settings(figures.solver));
    if (figures.narrowPhase != NarrowPhaseMethod::Automatic)
        add("Run", "narrow phase", NarrowPhaseName(figures.narrowPhase));
    add("Run", "threads", Text("%u", figures.threads));
    if (scene.usesSeed) add("Run", "seed", std::to_string(seed));
    add("Time", "a step, median", Text("%.3f ms", figures.stepMs.median));
    add("Time", "a step, 99th percentile", Text("%.3f ms", figures.stepMs.p99));
    add("Time", "a step, longest", Text("%.3f ms", figures.stepMs.max));
    if (figures.queryCount > 0)
        add("Time", "the batch, median",
            Text("%.3f ms for %d %s, %.3g/s", figures.queryMs.median, figures.queryCount, figures.queryName.c_str(),
                 QueriesPerSecond(figures)));
    if (figures.singleQueryNs > 0) add("Time", "one by a call of its own", Text("%.0f ns", figures.singleQueryNs));
    for (int stage = 0; stage < kStageCount; ++stage)
        add("Stages, median", StageName(stage), Text("%.3f ms", figures.stageMedianMs[static_cast<size_t>(stage)]));
    add("Result", "largest penetration",
        figures.deepestPair.empty()
            ? "none"
            : Text("%.2f mm, %s at step %d", 1000.0 * static_cast<double>(figures.largestPenetration),
                   figures.deepestPair.c_str(), figures.deepestStep));
    add("Result", "deepest for its size",
        figures.overlapPair.empty()
            ? "none"
            : Text("%.2g %% of the inner radius, %s, %.2f mm, %s at step %d", 100 * figures.overlap.relative,
                   JudgementOf(figures.overlap.relative), 1000 * figures.overlap.depth, figures.overlapPair.c_str(),
                   figures.overlap.step));
    add("Result", "energy",
        Energy(figures.energyAtStart) + " to " + Energy(figures.energyAtEnd) + ", springs included");
    AddRest(figures, lines);
    if (scene.accuracy) add("Result", "accuracy", AccuracyText(scene, figures));
    add("Result", "pose hash", HashText(figures.poseHash));
    if (figures.errors) AddErrors(*figures.errors, lines);
    AddRemarks(figures, lines);
    return lines;
}

std::string ReportText(const std::vector<ReportLine>& lines) {
    size_t width = 0;
    for (const ReportLine& line : lines) width = std::max(width, line.label.size());
    std::string text, section;
    for (const ReportLine& line : lines) {
        if (line.section != section) text += line.section + "\n";
        section = line.section;
        text += "  " + line.label + std::string(width + 2 - line.label.size(), ' ') + line.value + "\n";
    }
    return text;
}

namespace {

void AddRest(const RunFigures& figures, nlohmann::ordered_json& json) {
    const auto number = [](bool isKnown, double value) {
        return isKnown ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
    };
    const Drift drift = figures.drift.value_or(Drift{});
    const EnergyRise rise = figures.energyRise.value_or(EnergyRise{});
    const SleepTime sleep = figures.sleep.value_or(SleepTime{});
    json["largest_drift_m"] = number(figures.drift.has_value(), drift.largest);
    json["mean_drift_m"] = number(figures.drift.has_value(), drift.mean);
    json["end_speed_m_s"] = number(figures.endSpeed.has_value(), figures.endSpeed.value_or(0));
    json["asleep_s"] = number(sleep.seconds.has_value(), sleep.seconds.value_or(0));
    if (figures.sleep && !sleep.seconds) json["asleep_s"] = "never";
    json["asleep_limit_s"] = number(figures.sleep.has_value(), sleep.limit);
    json["energy_rise_j"] = number(figures.energyRise.has_value(), rise.joules);
    json["energy_rise"] = number(figures.energyRise.has_value(), rise.relative);
}

nlohmann::ordered_json ErrorsJson(const ErrorFigures& errors) {
    const auto worst = [](const WorstOfRun& w) {
        return nlohmann::ordered_json{{"value", w.value}, {"whose", w.whose}, {"step", w.step}};
    };
    return {{"joint_m", worst(errors.jointError)},
            {"joint_rad", worst(errors.jointAngle)},
            {"energy_gain_j", worst(errors.energyGain)},
            {"momentum_n_s", worst(errors.momentum)},
            {"angular_momentum_n_m_s", worst(errors.angularMomentum)},
            {"push_j", worst(errors.push)},
            {"substeps", worst(errors.effort)},
            {"solves_directly", errors.solvesDirectly},
            {"energy_change_j", errors.energyChange}};
}

}  // namespace

nlohmann::ordered_json ReportJson(const std::string& name, const RunFigures& figures, uint64_t seed) {
    nlohmann::ordered_json stages;
    for (int stage = 0; stage < kStageCount; ++stage)
        stages[StageName(stage)] = figures.stageMedianMs[static_cast<size_t>(stage)];
    const StepReport& last = figures.last;
    const Statistics& ms = ComparedMs(figures);
    nlohmann::ordered_json json{{"engine", "fulcrum"},
                                {"version", FULCRUM_VERSION_STRING},
                                {"scene", name},
                                {"threads", figures.threads},
                                {"bodies", figures.bodies},
                                {"contacts", last.contacts},
                                {"contact_points", last.contactPoints},
                                {"steps", figures.steps},
                                {"median_ms", ms.median},
                                {"mean_ms", ms.mean},
                                {"p99_ms", ms.p99},
                                {"max_ms", ms.max},
                                {"steps_per_s", figures.stepMs.mean > 0 ? 1000 / figures.stepMs.mean : 0},
                                {"accuracy", figures.accuracy},
                                {"nonfinite", figures.nonFinite},
                                {"hash", HashText(figures.poseHash)},
                                {"stages_ms", stages},
                                {"settings",
                                 {{"dt", figures.dt},
                                  {"substeps", figures.solver.substeps},
                                  {"velocity_iterations", figures.solver.velocityIterations},
                                  {"position_iterations", figures.solver.positionIterations},
                                  {"position_correction", PositionCorrectionName(figures.solver.positionCorrection)},
                                  {"narrow_phase", NarrowPhaseName(figures.narrowPhase)},
                                  {"seed", seed}}},
                                {"islands", figures.islands},
                                {"awake_islands", figures.awakeIslands},
                                {"awake_bodies", last.awakeBodies},
                                {"largest_penetration_m", figures.largestPenetration},
                                {"deepest_pair", figures.deepestPair},
                                {"largest_relative_penetration", figures.overlap.relative},
                                {"relative_penetration_m", figures.overlap.depth},
                                {"relative_penetration_pair", figures.overlapPair},
                                {"relative_penetration_step", figures.overlap.step},
                                {"energy_start_j", figures.energyAtStart},
                                {"energy_end_j", figures.energyAtEnd},
                                {"memory_bytes", figures.memoryBytes}};
    AddRest(figures, json);
    if (figures.errors) json["errors"] = ErrorsJson(*figures.errors);
    if (!figures.accuracies.empty()) json["accuracy_of_runs"] = figures.accuracies;
    if (figures.queryCount > 0) json[figures.queryName + "_per_s"] = QueriesPerSecond(figures);
    if (figures.singleQueryNs > 0) json["single_query_ns"] = figures.singleQueryNs;
    return json;
}

nlohmann::ordered_json RunDocument(const Scene& scene, const std::string& name, const RunFigures& figures,
                                   uint64_t seed) {
    using Json = nlohmann::ordered_json;
    Json json = FileHead("fulcrum-runner");
    json["units"] = {{"*_ms", "milliseconds of wall clock"},
                     {"*_ns", "nanoseconds of wall clock"},
                     {"*_m", "meters"},
                     {"*_m_s", "meters a second"},
                     {"*_j", "joules"},
                     {"*_s", "seconds"},
                     {"*_per_s", "a second of wall clock"},
                     {"*_bytes", "bytes"},
                     {"dt", "seconds"},
                     {"accuracy", "accuracy_unit"}};
    json.update(ReportJson(name, figures, seed));
    json["energy_at_start_j"] = figures.energyAtStart;
    json["energy_at_end_j"] = figures.energyAtEnd;
    json["accuracy_meaning"] = scene.accuracyMeaning;
    json["accuracy_unit"] = scene.accuracyUnit;
    json["accuracy_lowest"] = scene.accuracyRange ? Json(scene.accuracyRange->lowest) : Json();
    json["accuracy_highest"] = scene.accuracyRange ? Json(scene.accuracyRange->highest) : Json();
    const AccuracyVerdict verdict = VerdictOf(scene, figures);
    json["accuracy_passed"] = verdict == AccuracyVerdict::Unknown ? Json() : Json(verdict == AccuracyVerdict::Pass);
    return json;
}

}  // namespace fulcrum
