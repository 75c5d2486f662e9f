#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// P(U = u), u = 0..m n, of Mann's and Whitney's U of m and n samples: the largest of all is one of the m with a
// probability of m / (m + n), and then it is larger than all of the n.
std::vector<double> DistributionOfU(size_t m, size_t n) {
    // rows[j] is the distribution for i and j samples; i grows.
    std::vector<std::vector<double>> rows(n + 1, std::vector<double>{1});
    for (size_t i = 1; i <= m; ++i)
        for (size_t j = 1; j <= n; ++j) {
            std::vector<double> next(i * j + 1);
            const double fromFirst = static_cast<double>(i) / static_cast<double>(i + j);
            for (size_t u = 0; u < rows[j].size(); ++u) next[u + j] += fromFirst * rows[j][u];
            for (size_t u = 0; u < rows[j - 1].size(); ++u) next[u] += (1 - fromFirst) * rows[j - 1][u];
            rows[j] = std::move(next);
        }
    return rows[n];
}

// The largest k with 2 P(U < k) <= 1 - confidence.
size_t RankInQuotients(size_t m, size_t n, double confidence) {
    constexpr size_t kMostForExact = 40;
    double below = 0;
    if (m <= kMostForExact && n <= kMostForExact) {
        const std::vector<double> p = DistributionOfU(m, n);
        size_t k = 0;
        while (k < p.size() && 2 * (below + p[k]) <= 1 - confidence) below += p[k++];
        return k;
    }
    // Nearly normal: rounded downwards, and by the half that makes up for the steps.
    const double mean = 0.5 * static_cast<double>(m * n);
    const double deviation = std::sqrt(static_cast<double>(m * n * (m + n + 1)) / 12);
    const auto tail = [&](double k) { return std::erfc((mean - k + 0.5) / (deviation * std::sqrt(2.0))); };
    size_t k = 0;
    while (static_cast<double>(k + 1) <= mean && tail(static_cast<double>(k + 1)) <= 1 - confidence) ++k;
    return k;
}

// Between the k-th smallest and the k-th largest.
Interval Between(const std::vector<double>& sorted, size_t k) {
    if (k == 0) return {0, kInfinity};
    return {sorted[k - 1], sorted[sorted.size() - k]};
}

}  // namespace

double MedianOf(std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    const size_t count = samples.size();
    return count % 2 == 1 ? samples[count / 2] : 0.5 * (samples[count / 2 - 1] + samples[count / 2]);
}

RatioEstimate CompareSamples(const std::vector<double>& samples, const std::vector<double>& baseline,
                             double confidence) {
    std::vector<double> quotients;
    for (double sample : samples)
        for (double before : baseline) quotients.push_back(sample / before);
    std::sort(quotients.begin(), quotients.end());
    return {MedianOf(quotients), Between(quotients, RankInQuotients(samples.size(), baseline.size(), confidence))};
}

Verdict JudgeRatio(const RatioEstimate& estimate, double tolerance) {
    if (estimate.ratio > 1 + tolerance && estimate.interval.low > 1) return Verdict::Slower;
    if (estimate.ratio < 1 / (1 + tolerance) && estimate.interval.high < 1) return Verdict::Faster;
    return Verdict::Same;
}

const char* VerdictName(Verdict verdict) {
    switch (verdict) {
        case Verdict::Same: return "same";
        case Verdict::Faster: return "faster";
        case Verdict::Slower: return "slower";
    }
    return "";
}

}  // namespace fulcrum
