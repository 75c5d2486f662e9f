#include <Fulcrum/PerformanceTest/Accuracy/Advice.h>

#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>

#include <algorithm>
#include <cstdio>

namespace fulcrum::accuracy {
namespace {

constexpr double kMicrosecondsPerMs = 1000 * 60;  // per second of frames of 1/60 s

std::string LineOf(const RunRecord& run) {
    const std::string preset = run.setting.Preset();
    char error[32] = "not measured", text[160];
    if (run.isMeasured) std::snprintf(error, sizeof error, "%.3g %%", 100 * run.Error());
    std::snprintf(text, sizeof text, "%-20s error %s, %.4g ms a frame of 1/60 s%s%s%s", run.setting.Key().c_str(),
                  error, run.microseconds / kMicrosecondsPerMs, preset.empty() ? "" : " (preset ", preset.c_str(),
                  preset.empty() ? "" : ")");
    return text;
}

// Why the errors of a scene end where they do.
std::string WhyNoLessError(std::span<const RunRecord> runs) {
    const std::vector<size_t> envelope = Envelope(runs);
    if (envelope.empty()) return {};
    const RunRecord& best = runs[envelope.back()];
    std::string text;
    char line[240];
    if (const auto blewUp = std::ranges::count_if(runs, &RunRecord::blewUp); blewUp > 0) {
        std::snprintf(line, sizeof line, "  %d of %zu settings blew up\n", static_cast<int>(blewUp), runs.size());
        text += line;
    }
    for (const std::string& condition : best.failedConditions)
        text += "  at the most exact one this does not hold: " + condition + "\n";
    if (!best.worst.empty()) text += "  the largest error of the most exact one: " + best.worst + "\n";
    // The best run of at most half its cost.
    const RunRecord* cheaper = BestWithin(runs, 0.5 * best.microseconds);
    if (!cheaper || !(best.Error() > 0)) return text;
    const double work = best.microseconds / cheaper->microseconds, gain = cheaper->Error() / best.Error();
    constexpr double kNoGain = 1.1;
    if (gain < kNoGain)
        std::snprintf(line, sizeof line,
                      "  %.1f times the work has lowered the error by %.2g %% alone: more effort will not do; what is "
                      "left is in the scene\n",
                      work, 100 * (1 - 1 / gain));
    else
        std::snprintf(line, sizeof line,
                      "  the last %.1f times the work have lowered the error %.1f times: it still falls, beyond this "
                      "grid\n",
                      work, gain);
    return text + line;
}

// whyNot: lines that explain why there is no such setting.
std::string Advice(const SceneRuns& scene, const RunRecord* chosen, const std::string& wish,
                   const std::string& whyNot) {
    const std::vector<size_t> envelope = Envelope(scene.runs);
    std::string text = scene.scene->FullName() + ": " + scene.scene->what + "\nerror: " + scene.scene->error + "\n";
    if (std::ranges::none_of(scene.runs, &RunRecord::isMeasured))
        text += "It is not measured here: in no step bodies touched, or a joint was off what it holds.\n";
    text += "\n";
    if (envelope.empty()) return text + "No setting: all runs blew up.\n";
    if (!chosen) {
        text += "No setting of this grid has " + wish + ". The cheapest and the most exact one:\n  " +
                LineOf(scene.runs[envelope.front()]) + "\n  " + LineOf(scene.runs[envelope.back()]) + "\n";
        return whyNot.empty() ? text : text + "What stands in the way:\n" + whyNot;
    }
    // The choice is on the envelope, or as good as a run that is.
    size_t at = 0;
    while (at + 1 < envelope.size() && scene.runs[envelope[at]].Error() > chosen->Error()) ++at;
    const RunRecord& best = scene.runs[envelope[at]];
    text += "Cheapest setting with " + wish + ":\n  " + LineOf(best) + "\n";
    text += at + 1 < envelope.size() ? "Next better:\n  " + LineOf(scene.runs[envelope[at + 1]]) + "\n"
                                     : std::string("None of this grid is better.\n");
    text += at > 0 ? "Next cheaper:\n  " + LineOf(scene.runs[envelope[at - 1]]) + "\n"
                   : std::string("None of this grid is cheaper.\n");
    return text + "\n" + best.setting.Code() + "\n";
}

}  // namespace

std::string AdviceForError(const SceneRuns& scene, double error) {
    char wish[64];
    std::snprintf(wish, sizeof wish, "an error of at most %.3g %%", 100 * error);
    return Advice(scene, CheapestFor(scene.runs, error), wish, WhyNoLessError(scene.runs));
}

std::string AdviceForBudget(const SceneRuns& scene, double milliseconds) {
    char wish[64];
    std::snprintf(wish, sizeof wish, "at most %.3g ms a frame", milliseconds);
    const RunRecord* best = BestWithin(scene.runs, milliseconds * kMicrosecondsPerMs);
    std::string whyNot;
    if (const std::vector<size_t> envelope = Envelope(scene.runs); !envelope.empty()) {
        char line[64];
        std::snprintf(line, sizeof line, "  the cheapest takes %.3g times as long\n",
                      scene.runs[envelope.front()].microseconds / (milliseconds * kMicrosecondsPerMs));
        whyNot = line;
    }
    std::string text = Advice(scene, best, wish, whyNot);
    const std::string cheapest = "Cheapest setting with ";
    if (const size_t at = text.find(cheapest); at != std::string::npos)
        text.replace(at, cheapest.size(), "Most exact setting with ");
    return text;
}

}  // namespace fulcrum::accuracy
