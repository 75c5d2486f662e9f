// Medians of few noisy samples, with intervals that assume no distribution. Used by the benchmark; pure functions.
#pragma once

#include <vector>

namespace fulcrum {

// Bounds of a confidence interval; 0 and infinity where there are too few samples for the confidence.
struct Interval {
    double low, high;
};

// > 0 samples.
double MedianOf(std::vector<double> samples);

// The factor by which samples are larger than those of a baseline.
struct RatioEstimate {
    double ratio;
    Interval interval;
};

// Positive samples, > 0 of each. The median of all quotients of a sample and a baseline's sample, which is Hodges' and
// Lehmann's estimate of the shift between the logarithms; its interval, between the k-th smallest and the k-th largest
// quotient, follows from Mann's and Whitney's distribution of U: P(outside) = 2 P(U < k) (Hollander, Wolfe and Chicken,
// Nonparametric Statistical Methods, 2014, 4.2 and 4.3). At most 1 - confidence where the two have the same shape,
// whatever it is. Five samples of each are the fewest for a confidence of 99 %.
RatioEstimate CompareSamples(const std::vector<double>& samples, const std::vector<double>& baseline,
                             double confidence);

enum class Verdict { Same, Faster, Slower };

// Slower if the ratio exceeds the tolerance and the whole interval is above 1, so that noise does not explain it;
// faster likewise, below 1.
Verdict JudgeRatio(const RatioEstimate& estimate, double tolerance);
const char* VerdictName(Verdict verdict);

}  // namespace fulcrum
