// Reports of a run's measurements, as text and as JSON. Used by the runner and the benchmark; pure functions.
#pragma once

#include <Fulcrum/Samples/Runner/Simulation.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace fulcrum {

// The report's lines by section, for the viewer and the terminal.
std::vector<ReportLine> ReportLines(const Scene& scene, const RunFigures& figures, uint64_t seed);

// Lines of text with a heading for each section.
std::string ReportText(const std::vector<ReportLine>& lines);

// A word for an error relative to what it is measured by: "good" up to a hundredth, which nobody sees, "fair" up to a
// tenth, beyond that "poor".
const char* JudgementOf(double relative);

// Whether the accuracy figure is where the scene says. Unknown: the scene has no threshold, or the run is shorter or
// longer than the one that it is for.
enum class AccuracyVerdict : uint8_t { Unknown, Pass, Fail };
AccuracyVerdict VerdictOf(const Scene& scene, const RunFigures& figures);
// "0.0069 m, pass: 0 to 0.02 m is asked for (largest distance ...)".
std::string AccuracyText(const Scene& scene, const RunFigures& figures);

// A file of --json: FileHead, units, all of ReportJson, and the accuracy's meaning, unit, threshold and verdict.
nlohmann::ordered_json RunDocument(const Scene& scene, const std::string& name, const RunFigures& figures,
                                   uint64_t seed);

// One run with the field names that benchmarks of other engines use: scene threads bodies contacts contact_points steps
// median_ms mean_ms p99_ms max_ms steps_per_s accuracy nonfinite hash; and the engine's own. The ms of a scene that
// times a batch of queries are the batch's, and their number a second is there too (rays_per_s). What is not measured
// (the drift of a scene that is not built to stand, when all sleep where sleeping is off) is null, asleep_s may be
// "never". Numbers that are not finite are written as null.
nlohmann::ordered_json ReportJson(const std::string& name, const RunFigures& figures, uint64_t seed);

}  // namespace fulcrum
