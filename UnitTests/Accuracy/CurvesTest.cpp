// Envelope, slope, floor, advice and tables of made-up runs, worked out by hand.
#include <Fulcrum/PerformanceTest/Accuracy/Advice.h>
#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

namespace fulcrum::accuracy {
namespace {

RunRecord Made(int rate, double microseconds, double error, const SolverSettings& solver = {}) {
    RunRecord run;
    run.scene = "projectile";
    run.setting = {.rate = rate, .solver = solver};
    run.microseconds = microseconds;
    run.errors = {{"position", error}};
    run.observed = {error};
    run.blewUp = !(error <= 10);
    return run;
}

const std::vector<RunRecord>& Runs() {
    static const std::vector<RunRecord> runs = {
        Made(60, 100, 0.2),    // 0: on the envelope: the cheapest
        Made(60, 300, 0.3),    // 1: dearer and worse than 0
        Made(120, 200, 0.05),  // 2: on it
        Made(240, 200, 0.06),  // 3: as dear as 2, worse
        Made(480, 50, kNaN),   // 4: blew up
        Made(960, 900, 0.002)  // 5: on it
    };
    return runs;
}

TEST(Curves, EnvelopeHasTheRunsThatNoOtherBeats) {
    EXPECT_EQ(Envelope(Runs()), (std::vector<size_t>{0, 2, 5}));
    EXPECT_TRUE(Envelope(std::vector{Made(60, 1, kNaN)}).empty());
}

TEST(Curves, SlopeIsThatOfTheErrorOverTheTimeStep) {
    const auto slope = [](auto error) {
        std::vector<RunRecord> runs;
        for (const int rate : {30, 60, 120, 240, 480}) runs.push_back(Made(rate, rate, error(1.0 / rate)));
        return SlopeOverDt(runs);
    };
    EXPECT_NEAR(slope([](double dt) { return 3 * dt; }), 1, 1e-9);
    EXPECT_NEAR(slope([](double dt) { return 0.5 * dt * dt; }), 2, 1e-9);
    // What lies on the floor does not count.
    EXPECT_NEAR(slope([](double dt) { return std::max(dt * dt, 1e-4); }), 2, 1e-9);
    EXPECT_TRUE(std::isnan(slope([](double) { return 0.0; })));
    // Nor is there an order in rounding.
    EXPECT_TRUE(std::isnan(slope([](double dt) { return 1e-9 / dt; })));
    // Other efforts do not count, nor what blew up.
    EXPECT_NEAR(SlopeOverDt(std::vector{Made(30, 1, 0.04), Made(60, 1, 0.01), Made(120, 1, 5, SolverSettings::Fast()),
                                        Made(240, 1, kNaN)}),
                2, 1e-9);
    EXPECT_TRUE(std::isnan(SlopeOverDt(std::vector{Made(60, 1, 0.01)})));
}

TEST(Curves, CostsOfAccuracy) {
    EXPECT_EQ(Floor(Runs()), 0.002);
    EXPECT_EQ(CheapestFor(Runs(), 0.5), &Runs()[0]);
    EXPECT_EQ(CheapestFor(Runs(), 0.1), &Runs()[2]);
    EXPECT_EQ(CheapestFor(Runs(), 0.01), &Runs()[5]);
    EXPECT_EQ(CheapestFor(Runs(), 0.001), nullptr);
    EXPECT_EQ(BestWithin(Runs(), 250), &Runs()[2]);
    EXPECT_EQ(BestWithin(Runs(), 60), nullptr);
    std::vector<RunRecord> gated(Runs());
    for (const size_t i : {size_t{0}, size_t{2}, size_t{3}}) gated[i].failedConditions = {"stands"};
    EXPECT_EQ(CheapestThatPasses(gated), &gated[1]);
    EXPECT_EQ(FindPreset(Runs(), "balanced"), &Runs()[0]);
    EXPECT_EQ(FindPreset(Runs(), "fast"), nullptr);
}

TEST(Curves, SelfErrorIsFromTheFinestSettingThatDidNotBlowUp) {
    std::vector<RunRecord> runs = {Made(60, 1, 0.5), Made(240, 1, 0.1), Made(960, 1, kNaN)};
    AddSelfErrors(runs);
    EXPECT_NEAR(runs[0].selfError, 0.4, 1e-12);
    EXPECT_EQ(runs[1].selfError, 0);
    EXPECT_TRUE(std::isnan(runs[2].selfError));
}

TEST(Advice, NamesTheCheapestSettingAndItsNeighbors) {
    const SceneRuns scene{FindLabScenes("projectile")[0], Runs()};
    const std::string advice = AdviceForError(scene, 0.1);
    const size_t chosen = advice.find("soft 1/120"), better = advice.find("soft 1/960"),
                 cheaper = advice.find("soft 1/60");
    ASSERT_NE(cheaper, std::string::npos) << advice;
    EXPECT_LT(chosen, better);
    EXPECT_LT(better, cheaper);
    EXPECT_NE(advice.find("Update(1.0 / 120)"), std::string::npos) << advice;
    EXPECT_NE(AdviceForError(scene, 0.001).find("No setting"), std::string::npos);
    // 250 us a second are 0.0042 ms a frame.
    EXPECT_NE(AdviceForBudget(scene, 0.0042).find("Update(1.0 / 120)"), std::string::npos);
    EXPECT_NE(AdviceForBudget(scene, 1e-6).find("No setting"), std::string::npos);
}

TEST(Tables, StandBetweenTheirMarks) {
    const std::vector<SceneRuns> scenes = {{FindLabScenes("projectile")[0], Runs()}};
    const std::string tables = TablesOf(scenes, {});
    EXPECT_NE(tables.find("| `projectile` | 0.2 @ 100 | 0.2 @ 100 |"), std::string::npos) << tables;
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("fulcrum-tables-" + std::to_string(getpid()) + ".md");
    std::ofstream(path) << "before\n<!-- accuracy lab: begin -->\nold\n<!-- accuracy lab: end -->\nafter\n";
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(WriteTables("| new |\n", path));
    std::ostringstream content;
    content << std::ifstream(path).rdbuf();
    EXPECT_EQ(content.str(), "before\n<!-- accuracy lab: begin -->\n\n| new |\n\n<!-- accuracy lab: end -->\nafter\n");
    std::ofstream(path) << "no marks\n";
    EXPECT_FALSE(WriteTables("| new |\n", path));
    std::filesystem::remove(path);
}

TEST(Tables, NumbersAreShort) {
    EXPECT_EQ(ShortNumber(0), "0");
    EXPECT_EQ(ShortNumber(0.01234), "0.012");
    EXPECT_EQ(ShortNumber(1.26e-7), "1.3e-7");
    EXPECT_EQ(ShortNumber(523), "523");
    EXPECT_EQ(ShortNumber(12345), "12.3k");
    EXPECT_EQ(ShortNumber(2.5e6), "2.5M");
    EXPECT_EQ(ShortNumber(kNaN), "–");
}

}  // namespace
}  // namespace fulcrum::accuracy
