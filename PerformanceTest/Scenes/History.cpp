#include <Fulcrum/PerformanceTest/Scenes/History.h>

#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

namespace fulcrum {
namespace {

template <class... Values>
std::string Text(const char* format, Values... values) {
    char text[256];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

// Eight heights, the largest time the highest.
std::string Bar(double time, double largest) {
    static const char* const kBars[] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    return kBars[std::clamp(static_cast<int>(8 * time / largest), 0, 7)];
}

std::string Row(const std::string& scene, int threads, const std::vector<std::optional<double>>& times) {
    double first = 0, largest = 0;
    for (const std::optional<double>& time : times) {
        if (time && first == 0) first = *time;
        if (time) largest = std::max(largest, *time);
    }
    std::string bars, numbers;
    for (const std::optional<double>& time : times) {
        bars += time ? Bar(*time, largest) : " ";
        numbers += time ? Text(" %7.3f", *time / first) : Text(" %7s", "-");
    }
    return Text("%-16s %3d  ", scene.c_str(), threads) + bars + " " + numbers + "\n";
}

}  // namespace

std::string HistoryText(std::vector<SavedRuns> saved, const std::vector<std::string>& scenes) {
    std::stable_sort(saved.begin(), saved.end(), [](auto& a, auto& b) { return a.date < b.date; });
    std::string text;
    std::vector<std::pair<std::string, int>> rows;
    for (size_t i = 0; i < saved.size(); ++i) {
        text += Text("%3zu  %s  %-12s  %s, %s\n", i + 1, saved[i].date.c_str(), saved[i].commit.c_str(),
                     saved[i].file.c_str(), saved[i].cpu.c_str());
        for (const SavedRun& run : saved[i].runs) {
            const std::pair<std::string, int> row(run.scene, run.threads);
            const bool isWanted = scenes.empty() || std::find(scenes.begin(), scenes.end(), run.scene) != scenes.end();
            if (isWanted && std::find(rows.begin(), rows.end(), row) == rows.end()) rows.push_back(row);
        }
    }
    std::string heading = Text("\n%-16s %3s  ", "scene", "thr") + std::string(saved.size(), ' ') + " ";
    for (size_t i = 0; i < saved.size(); ++i) heading += Text(" %7zu", i + 1);
    text += heading + "\n";
    for (const auto& [scene, threads] : rows) {
        std::vector<std::optional<double>> times;
        for (const SavedRuns& runs : saved) {
            const SavedRun* run = runs.Find(scene, threads);
            times.push_back(run ? std::optional(MedianOf(run->relativeTimes)) : std::nullopt);
        }
        text += Row(scene, threads, times);
    }
    return text + "times of a step in units of the reference kernel, relative to the first\n";
}

}  // namespace fulcrum
