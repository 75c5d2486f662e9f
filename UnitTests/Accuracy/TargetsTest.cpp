// What an error costs with a target, against fixed efforts.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/PerformanceTest/Accuracy/Targets.h>

#include <nlohmann/json.hpp>

#include <cmath>

namespace fulcrum::accuracy {
namespace {

RunRecord Make(Family family, int substeps, double error, double traversals) {
    RunRecord run;
    run.scene = "heavy_chain.100";
    run.setting = {.solver = {.substeps = substeps}, .family = family, .target = family == Family::Target ? 0.01f : 0};
    run.errors = {{"stretch", error}};
    run.traversals = traversals;
    return run;
}

TEST(Targets, AreComparedWithTheCheapestFixedEffortThatReachesTheError) {
    std::vector<RunRecord> runs = {
        Make(Family::Fixed, 1, 0.2, 100),   Make(Family::Fixed, 4, 0.009, 400),     Make(Family::Fixed, 8, 0.008, 800),
        Make(Family::Target, 1, 0.01, 500), Make(Family::Target, 2, 0.0005, 10000), Make(Family::Soft, 4, 0, 1),
    };
    const TargetCost cost = CompareTarget(runs, 0.01);
    EXPECT_EQ(cost.fixed, &runs[1]);
    EXPECT_EQ(cost.target, &runs[3]);
    EXPECT_EQ(cost.Ratio(), 1.25);
    EXPECT_TRUE(std::isnan(CompareTarget(runs, 0.001).Ratio())) << "no fixed effort reaches it";
    runs[4].blewUp = true;
    runs.push_back(Make(Family::Fixed, 16, 0.0001, 1600));
    EXPECT_TRUE(std::isinf(CompareTarget(runs, 0.001).Ratio())) << "no target does";

    const SceneRuns scene{FindLabScenes("heavy_chain.100")[0], runs};
    const std::string table = TargetTable({&scene, 1});
    EXPECT_NE(table.find("| `heavy_chain.100` | 1 % | 1/60, 4: 0.009 @ 400 | 1/60, 1, 0.01: 0.01 @ 500 | 1.25 |"),
              std::string::npos)
        << table;
    EXPECT_NE(table.find("| never | **inf** |"), std::string::npos) << table;
    EXPECT_NE(table.find("Of 3 pairs"), std::string::npos) << table;
    EXPECT_NE(table.find(", 2 cost at most 1.3 times"), std::string::npos) << table;
}

TEST(Targets, AreNamedAndSurviveTheirFile) {
    RunRecord run = Make(Family::Target, 2, 0.5, 3);
    run.setting.target = 0.0015f;
    run.effortReturns = 4;
    EXPECT_EQ(run.setting.Key(), "target 1/60 2 1 1 0.0015");
    const Result<RunRecord> read = RecordFromJson(ToJson(run));
    ASSERT_TRUE(read);
    EXPECT_EQ(read.Value().setting, run.setting);
    EXPECT_EQ(read.Value().effortReturns, 4);
}

// A cube on a light one: an island that is solved directly, in as many substeps as without a target. Its work is that
// of its traversals: factorizations are not counted.
TEST(Targets, WorkIsThatOfTheIslandsEffort) {
    const auto traversalsOf = [](const Setting& setting) {
        LabRun run(setting, 100, true, 1);
        FindLabScenes("heavy_on_light.100")[0]->run(run);
        return run.work.traversals / run.work.simulatedSeconds;
    };
    SolverSettings solver;
    solver.substeps = 1;
    const double fixed = traversalsOf({.solver = solver, .family = Family::Fixed});
    EXPECT_LE(fixed, 2 * 2 * 60 + 1e-9);  // two contacts, two passes a substep; while they bounce less
    EXPECT_GE(fixed, 0.95 * 2 * 2 * 60);
    const double target = traversalsOf({.solver = solver, .family = Family::Target, .target = 0.004f});
    EXPECT_GE(target, 0.95 * 2 * 2 * 60);
    EXPECT_LE(target, 2 * 2 * 60 + 1e-9);
}

}  // namespace
}  // namespace fulcrum::accuracy
