// The benchmark's intervals and verdicts, on made-up samples.
#include <Fulcrum/PerformanceTest/Scenes/ReferenceKernel.h>
#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace fulcrum {
namespace {

// Times around `median` with a relative noise of some per cent, lognormal, as times are: never below zero, with a tail
// of long ones.
std::vector<double> Times(std::mt19937& random, double median, double noise, int count) {
    std::normal_distribution<double> normal(0, noise);
    std::vector<double> times;
    for (int i = 0; i < count; ++i) times.push_back(median * std::exp(normal(random)));
    return times;
}

// How many of 1000 comparisons of 7 with 7 samples have that verdict.
int CountVerdicts(double ratio, double noise, double tolerance, Verdict wanted) {
    std::mt19937 random(1);
    int count = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::vector<double> before = Times(random, 3, noise, 7), now = Times(random, 3 * ratio, noise, 7);
        count += JudgeRatio(CompareSamples(now, before, 0.99), tolerance) == wanted;
    }
    return count;
}

TEST(SampleStatistics, MedianOfAnOddAndAnEvenNumber) {
    EXPECT_DOUBLE_EQ(MedianOf({3, 1, 2}), 2);
    EXPECT_DOUBLE_EQ(MedianOf({4, 1, 2, 3}), 2.5);
}

// At 99 % U of 5 and 5 samples is below 1 with 2 / C(10, 5) = 0.0079, so the bounds are the outermost quotients.
TEST(SampleStatistics, IntervalOfARatioIsThatOfMannAndWhitney) {
    const std::vector<double> before{1, 1.1, 1.2, 1.3, 1.4}, now{2, 2.1, 2.2, 2.3, 2.4};
    const RatioEstimate five = CompareSamples(now, before, 0.99);
    EXPECT_DOUBLE_EQ(five.interval.low, 2 / 1.4);
    EXPECT_DOUBLE_EQ(five.interval.high, 2.4);
    EXPECT_GT(five.ratio, 2.1 / 1.3);
    EXPECT_LT(five.ratio, 2.3 / 1.1);
    const RatioEstimate four = CompareSamples({2, 2, 2, 2}, {1, 1, 1, 1}, 0.99);
    EXPECT_EQ(four.interval.low, 0);
    EXPECT_EQ(JudgeRatio(four, 0.1), Verdict::Same) << "too few to say more";
}

// 99 % of the intervals contain the ratio. Of 1000 at most 10 + 4 standard deviations of sqrt(10) should not; the tails
// of the exact distribution lie below its step.
TEST(SampleStatistics, IntervalsContainTheRatio) {
    std::mt19937 random(2);
    for (const int count : {5, 7, 45}) {
        int outside = 0;
        for (int i = 0; i < 1000; ++i) {
            const std::vector<double> before = Times(random, 2, 0.2, count), now = Times(random, 3, 0.2, 7);
            const RatioEstimate estimate = CompareSamples(now, before, 0.99);
            outside += estimate.interval.low > 1.5 || estimate.interval.high < 1.5;
            EXPECT_LE(estimate.interval.low, estimate.ratio);
            EXPECT_GE(estimate.interval.high, estimate.ratio);
        }
        EXPECT_LE(outside, 23) << count;
    }
}

TEST(SampleStatistics, FindsATwentyPerCentSlowdownInFivePerCentNoise) {
    EXPECT_GE(CountVerdicts(1.2, 0.05, 0.1, Verdict::Slower), 990);
    EXPECT_GE(CountVerdicts(1 / 1.2, 0.05, 0.1, Verdict::Faster), 990);
}

TEST(SampleStatistics, ThreePerCentInTenPerCentNoiseAreTheSame) {
    EXPECT_GE(CountVerdicts(1.03, 0.1, 0.1, Verdict::Same), 980);
}

// Of 20 comparisons of the same program at least 19 must say so; here 998 of 1000, in whatever noise.
TEST(SampleStatistics, TheSameIsTheSame) {
    for (const double noise : {0.001, 0.02, 0.1, 0.5})
        EXPECT_GE(CountVerdicts(1, noise, 0.1, Verdict::Same), 980) << noise;
    for (const double noise : {0.001, 0.02, 0.1, 0.5})
        EXPECT_GE(CountVerdicts(1, noise, 0, Verdict::Same), 970) << noise;
}

// Units of 1 ms, of which every fifth is interrupted for 5 ms: one takes 1 ms, five in a row take 10.
TEST(ReferenceKernel, UnitsAreInterruptedAsOftenAsAStepOfThatLength) {
    std::vector<double> units;
    for (int i = 0; i < 100; ++i) units.push_back(i % 5 == 0 ? 6 : 1);
    EXPECT_DOUBLE_EQ(UnitsIn(0.5, {units}), 0.5);
    EXPECT_DOUBLE_EQ(UnitsIn(1, {units, units}), 1);
    EXPECT_DOUBLE_EQ(UnitsIn(10, {units}), 5);
    EXPECT_DOUBLE_EQ(UnitsIn(20, {units}), 10);
    EXPECT_DOUBLE_EQ(UnitsIn(20.5, {units}), 10.5);
    EXPECT_DOUBLE_EQ(UnitsIn(400, {units}), 200) << "more than there are";
}

TEST(ReferenceKernel, TakesTime) {
    const ReferenceKernel kernel;
    for (const int threads : {1, 2})
        for (double ms : kernel.Time(threads)) EXPECT_GT(ms, 0);
}

// Noise alone, or a change alone, is not enough.
TEST(SampleStatistics, SlowerIsBeyondToleranceAndBeyondNoise) {
    EXPECT_EQ(JudgeRatio({1.08, {1.05, 1.11}}, 0.1), Verdict::Same);
    EXPECT_EQ(JudgeRatio({1.3, {0.9, 1.8}}, 0.1), Verdict::Same);
    EXPECT_EQ(JudgeRatio({1.3, {1.1, 1.5}}, 0.1), Verdict::Slower);
    EXPECT_EQ(JudgeRatio({0.92, {0.9, 0.95}}, 0.1), Verdict::Same);
    EXPECT_EQ(JudgeRatio({0.8, {0.7, 0.9}}, 0.1), Verdict::Faster);
}

}  // namespace
}  // namespace fulcrum
