// The errors of runs against those of a file: only what has become worse fails.
#include <Fulcrum/PerformanceTest/Accuracy/Baseline.h>

#include <gtest/gtest.h>

#include <functional>

namespace fulcrum::accuracy {
namespace {

RunRecord Make(const char* scene, int rate, double error) {
    RunRecord run;
    run.scene = scene;
    run.setting.rate = rate;
    run.errors = {{"position", error}, {"energy", 0.25}};
    run.traversals = 1000;
    return run;
}

class Baseline : public ::testing::Test {
protected:
    // After a change of the runs.
    Comparison After(const std::function<void(std::vector<RunRecord>&)>& change) {
        std::vector<RunRecord> now = runs_;
        change(now);
        Result<Comparison> compared = CompareWithBaseline(BaselineOf(runs_, true), now, true);
        EXPECT_TRUE(compared) << (compared ? "" : compared.GetError().message);
        return compared ? compared.Value() : Comparison{};
    }

    std::vector<RunRecord> runs_ = {Make("incline", 30, 1.0 / 3), Make("incline", 60, 1e-3), Make("rope", 60, 0)};
};

TEST_F(Baseline, OfTheSameRunsIsTheSame) {
    runs_[1].failedConditions = {"finite poses"};
    runs_[2].errors[0].value = kNaN;
    const Comparison same = After([](auto&) {});
    EXPECT_TRUE(same.worse.empty());
    EXPECT_TRUE(same.better.empty());
    EXPECT_EQ(same.same, 6u);
}

TEST_F(Baseline, TellsWorseFromBetterByTheDigitsThatItKeeps) {
    EXPECT_EQ(After([](auto& runs) { runs[0].errors[0].value *= 1 + 1e-6; }).same, 6u);
    EXPECT_EQ(After([](auto& runs) { runs[0].errors[0].value *= 1 + 1e-5; }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].errors[0].value *= 1 - 1e-5; }).better.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[2].errors[0].value = 1e-10; }).same, 6u);
    EXPECT_EQ(After([](auto& runs) { runs[2].errors[0].value = 1e-8; }).worse.size(), 1u);
    const Comparison both = After([](auto& runs) {
        runs[0].errors[0].value = 1;
        runs[1].errors[0].value = 1e-4;
    });
    ASSERT_EQ(both.worse.size(), 1u);
    EXPECT_EQ(both.worse[0], "incline, soft 1/30 4 1 1: position 0.3333333 -> 1");
    ASSERT_EQ(both.better.size(), 1u);
    EXPECT_EQ(both.better[0], "incline, soft 1/60 4 1 1: position 0.001 -> 0.0001");
}

TEST_F(Baseline, FailsWhereARunTakesATenthMoreWork) {
    EXPECT_EQ(After([](auto& runs) { runs[0].traversals = 1099; }).worse.size(), 0u);
    const Comparison dearer = After([](auto& runs) { runs[0].traversals = 1500; });
    ASSERT_EQ(dearer.worse.size(), 1u);
    EXPECT_EQ(dearer.worse[0], "incline, soft 1/30 4 1 1: traversals per second 1000 -> 1500");
    ASSERT_EQ(dearer.costs.size(), 3u);
    EXPECT_EQ(dearer.costs[0].ratio, 1.5);
    EXPECT_EQ(dearer.costs[1].ratio, 1);
    EXPECT_EQ(After([](auto& runs) { runs[0].traversals = 500; }).better.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].traversals = kNaN; }).worse.size(), 1u);
    // Where nothing is solved there is no ratio.
    runs_[2].traversals = 0;
    EXPECT_EQ(After([](auto&) {}).costs.size(), 2u);
    EXPECT_EQ(After([](auto& runs) { runs[2].traversals = 10; }).worse.size(), 1u);
}

TEST_F(Baseline, FailsWhereARunBlowsUpFailsAGateOrIsMissing) {
    EXPECT_EQ(After([](auto& runs) { runs[0].errors[0].value = kNaN; }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].failedConditions.push_back("finite poses"); }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].errors.pop_back(); }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].errors.push_back({"gap", 0}); }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs.erase(runs.begin()); }).worse.size(), 1u);
    EXPECT_EQ(After([](auto& runs) { runs[0].setting.rate = 120; }).worse.size(), 2u);
    // Scenes that were not run are not compared.
    EXPECT_TRUE(After([](auto& runs) { runs.pop_back(); }).worse.empty());
    // What gave no number before, and gives one now, is better.
    runs_[0].errors[0].value = kNaN;
    EXPECT_EQ(After([](auto& runs) { runs[0].errors[0].value = 5; }).better.size(), 1u);
}

TEST_F(Baseline, RefusesWhatIsNone) {
    for (const char* text : {"", "{}", "[1]", "{\"fulcrum_accuracy_baseline\": 99, \"quick\": true, \"scenes\": {}}",
                             "{\"fulcrum_accuracy_baseline\": 2, \"quick\": true, \"scenes\": {\"rope\": 3}}"})
        EXPECT_FALSE(CompareWithBaseline(text, runs_, true)) << text;
    EXPECT_FALSE(CompareWithBaseline(BaselineOf(runs_, false), runs_, true));
    EXPECT_TRUE(CompareWithBaseline(BaselineOf({}, true), {}, true));
}

}  // namespace
}  // namespace fulcrum::accuracy
