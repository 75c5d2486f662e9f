#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace fulcrum::accuracy {
namespace {

// Cheaper first; of equal cost the more exact one.
bool IsCheaper(const RunRecord& a, const RunRecord& b) {
    return a.microseconds != b.microseconds ? a.microseconds < b.microseconds : a.Error() < b.Error();
}

}  // namespace

std::vector<size_t> Envelope(std::span<const RunRecord> runs) {
    std::vector<size_t> order(runs.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::erase_if(order, [&](size_t i) { return runs[i].blewUp; });
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return IsCheaper(runs[a], runs[b]); });
    std::vector<size_t> envelope;
    for (const size_t i : order)
        if (envelope.empty() || runs[i].Error() < runs[envelope.back()].Error()) envelope.push_back(i);
    return envelope;
}

double SlopeOverDt(std::span<const RunRecord> runs) {
    struct Point {
        double dt, error;
    };
    std::vector<Point> points;
    for (const RunRecord& run : runs)
        if (run.setting.family == Family::Soft && run.setting.solver == SolverSettings{} && !run.blewUp)
            points.push_back({run.setting.Dt(), run.Error()});
    std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.dt > b.dt; });
    double least = std::numeric_limits<double>::infinity();
    for (const Point& point : points) least = std::min(least, point.error);
    if (points.empty() || !(points[0].error >= std::max(3 * least, 1e-6))) return kNaN;
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        if (i >= 2 && points[i].error <= 2 * least) continue;
        if (!(points[i].error > 0)) return kNaN;
        const double x = std::log(points[i].dt), y = std::log(points[i].error);
        n += 1;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return n < 2 ? kNaN : (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double Floor(std::span<const RunRecord> runs) {
    double least = kNaN;
    for (const RunRecord& run : runs)
        if (!run.blewUp && !(run.Error() >= least)) least = run.Error();
    return least;
}

const RunRecord* CheapestFor(std::span<const RunRecord> runs, double error) {
    const RunRecord* best = nullptr;
    for (const RunRecord& run : runs)
        if (!run.blewUp && run.Error() <= error && (!best || IsCheaper(run, *best))) best = &run;
    return best;
}

const RunRecord* CheapestThatPasses(std::span<const RunRecord> runs) {
    const RunRecord* best = nullptr;
    for (const RunRecord& run : runs)
        if (!run.blewUp && run.failedConditions.empty() && (!best || IsCheaper(run, *best))) best = &run;
    return best;
}

const RunRecord* BestWithin(std::span<const RunRecord> runs, double microseconds) {
    const RunRecord* best = nullptr;
    for (const RunRecord& run : runs) {
        if (run.blewUp || !(run.microseconds <= microseconds)) continue;
        if (!best || run.Error() < best->Error() || (run.Error() == best->Error() && IsCheaper(run, *best)))
            best = &run;
    }
    return best;
}

const RunRecord* FindPreset(std::span<const RunRecord> runs, const std::string& preset) {
    for (const RunRecord& run : runs)
        if (run.setting.Preset() == preset) return &run;
    return nullptr;
}

}  // namespace fulcrum::accuracy
