#include <Fulcrum/PerformanceTest/Accuracy/Advice.h>

#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>

#include <algorithm>
#include <cstdio>

namespace fulcrum::accuracy {
namespace {

constexpr double kMicrosecondsPerMs = 1000 * 60;  // per second of frames of 1/60 s

std::string LineOf(const RunRecord& run) {
    const std::string preset = run.setting.Preset();
    char text[160];
    std::snprintf(text, sizeof text, "%-20s error %.3g %%, %.4g ms a frame of 1/60 s%s%s%s", run.setting.Key().c_str(),
                  100 * run.Error(), run.microseconds / kMicrosecondsPerMs, preset.empty() ? "" : " (preset ",
                  preset.c_str(), preset.empty() ? "" : ")");
    return text;
}

std::string Advice(const SceneRuns& scene, const RunRecord* chosen, const std::string& wish) {
    const std::vector<size_t> envelope = Envelope(scene.runs);
    std::string text = scene.scene->FullName() + ": " + scene.scene->what + "\nerror: " + scene.scene->error + "\n\n";
    if (envelope.empty()) return text + "No setting: all runs blew up.\n";
    if (!chosen) {
        return text + "No setting of this grid has " + wish + ". The cheapest and the most exact one:\n  " +
               LineOf(scene.runs[envelope.front()]) + "\n  " + LineOf(scene.runs[envelope.back()]) + "\n";
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
    return Advice(scene, CheapestFor(scene.runs, error), wish);
}

std::string AdviceForBudget(const SceneRuns& scene, double milliseconds) {
    char wish[64];
    std::snprintf(wish, sizeof wish, "at most %.3g ms a frame", milliseconds);
    const RunRecord* best = BestWithin(scene.runs, milliseconds * kMicrosecondsPerMs);
    std::string text = Advice(scene, best, wish);
    const std::string cheapest = "Cheapest setting with ";
    if (const size_t at = text.find(cheapest); at != std::string::npos)
        text.replace(at, cheapest.size(), "Most exact setting with ");
    return text;
}

}  // namespace fulcrum::accuracy
