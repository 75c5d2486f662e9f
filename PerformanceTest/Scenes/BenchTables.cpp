#include <Fulcrum/PerformanceTest/Scenes/BenchTables.h>

#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>

#include <cstdio>
#include <optional>

namespace fulcrum {
namespace {

std::string Number(const char* format, std::optional<double> value) {
    if (!value) return "-";
    char text[32];
    std::snprintf(text, sizeof text, format, *value);
    return text;
}

std::string SleepText(const std::optional<SleepTime>& sleep) {
    if (!sleep) return "-";
    return sleep->seconds ? Number("%.2f", *sleep->seconds) : "never";
}

}  // namespace

void PrintTimesHeading(const Peer* peer) {
    std::printf("%-16s %3s %7s %8s %5s  %9s %9s %9s %9s %9s  %11s  %7s  %8s  %-16s", "scene", "thr", "bodies",
                "contacts", "steps", "median ms", "mean ms", "p99 ms", "max ms", "steps/s", "accuracy", "overlap",
                "memory", "hash");
    if (peer) std::printf("  %9s %6s  %11s", (std::string(peer->name) + " ms").c_str(), "ratio", "its figure");
    std::printf("\n");
}

void PrintTimes(const TimedScene& scene, const Peer* peer, const PeerRuns& peerRuns) {
    const RunFigures& run = scene.Figures();
    const Statistics& ms = ComparedMs(run);
    std::printf("%-16s %3u %7zu %8u %5d  %9.4f %9.4f %9.4f %9.4f %9.1f  %11.5g  %7.4f  %5.0f MB  %s",
                scene.Definition().name, run.threads, run.bodies, run.last.contacts, run.steps, ms.median, ms.mean,
                ms.p99, ms.max, 1000 / run.stepMs.mean, run.accuracy, run.overlap.relative,
                static_cast<double>(run.memoryBytes) / 1e6, HashText(run.poseHash).c_str());
    if (peer && !peerRuns.ms.empty())
        std::printf("  %9.4f %6.3f  %11.5g", MedianOf(peerRuns.ms), TimedScene::RatioTo(peerRuns, scene),
                    peerRuns.accuracy);
    std::printf("\n");
    if (!peerRuns.whyNot.empty()) std::printf("%20s not run in %s: %s\n", "", peer->name, peerRuns.whyNot.c_str());
    if (run.queryCount > 0)
        std::printf("%20s %d %s a batch, which the ms are of: %.4g %s/s\n", "", run.queryCount, run.queryName.c_str(),
                    QueriesPerSecond(run), run.queryName.c_str());
    if (run.singleQueryNs > 0) std::printf("%20s %.4g ns for one by a call of its own\n", "", run.singleQueryNs);
    std::fflush(stdout);
}

void PrintAccuracy(const std::vector<std::unique_ptr<TimedScene>>& scenes) {
    std::printf("\n%-16s %11s  %7s  %10s %10s  %10s  %8s  %11s %9s\n", "scene", "accuracy", "overlap", "drift mm",
                "mean mm", "end m/s", "asleep s", "rise J", "rise");
    const Scene* last = nullptr;
    for (const std::unique_ptr<TimedScene>& scene : scenes) {
        if (&scene->Definition() == last) continue;  // with any number of threads it is the same
        last = &scene->Definition();
        const RunFigures& run = scene->Figures();
        std::optional<double> largest, mean, joules, relative;
        if (run.drift) {
            largest = 1000 * run.drift->largest;
            mean = 1000 * run.drift->mean;
        }
        if (run.energyRise) {
            joules = run.energyRise->joules;
            relative = run.energyRise->relative;
        }
        std::printf("%-16s %11.5g  %7.4f  %10s %10s  %10s  %8s  %11s %9s\n", last->name, run.accuracy,
                    run.overlap.relative, Number("%.4g", largest).c_str(), Number("%.4g", mean).c_str(),
                    Number("%.5g", run.endSpeed).c_str(), SleepText(run.sleep).c_str(), Number("%.4g", joules).c_str(),
                    Number("%.2g", relative).c_str());
    }
    std::printf(
        "accuracy: see ./fulcrum run; drift: sideways from where bodies were built, the largest and the mean;\n"
        "end: the largest speed in the last second; rise: of kinetic plus potential energy, also over that at "
        "the start\n");
}

}  // namespace fulcrum
