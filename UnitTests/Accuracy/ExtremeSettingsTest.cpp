// Every scene at the extremes, shortened, at all presets and at odd settings, with 1 and 2 threads: what holds of any
// physics, whatever the effort, and what scenes ask for that no effort may break.
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/UnitTests/Accuracy/LabSceneNames.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <cmath>
#include <string_view>

namespace fulcrum::accuracy {
namespace {

std::vector<Setting> PresetsAndOddSettings() {
    std::vector<Setting> settings;
    for (const SolverSettings& solver :
         {SolverSettings::Fast(), SolverSettings::Balanced(), SolverSettings::Accurate(), SolverSettings::Reference(),
          SolverSettings{.substeps = 1}, SolverSettings{.substeps = 64}, SolverSettings{.positionIterations = 0}})
        settings.push_back({.solver = solver});
    settings.push_back({.solver = {.positionCorrection = PositionCorrection::Baumgarte}, .family = Family::Baumgarte});
    return settings;
}

// Requirements that are about how much effort a scene needs: that it stands, is deep, sleeps.
bool DependsOnEffort(const std::string& gate) {
    for (const char* each :
         {"stands", "stretches by less than 10 %", "sideways and upwards below 1 cm/s", "height to 1 mm",
          "sinks by at most 4 mm a layer", "the stack survives", "falls asleep in the same step",
          "exit speed at most contactPushSpeed", "drifts by less than 5 % of an edge", "overlap at most 4 mm",
          "all sleep", "sleeps", "back within its limits in 5 s", "no drift growth"})
        if (gate == each) return true;
    return false;
}

std::vector<LabScene> ExtremeScenes() {
    std::vector<LabScene> scenes;
    for (const LabScene& scene : AllLabScenes())
        if (scene.isExtreme) scenes.push_back(scene);
    return scenes;
}

class ExtremeSettings : public ::testing::TestWithParam<LabScene> {};

TEST_P(ExtremeSettings, KeepWhatNoEffortMayBreak) {
    const LabScene& scene = GetParam();
    ThreadPool two(2);
    // 4096 spheres at one point and the slab of a kilometer take minutes: every day they run at the default alone.
    const bool isDefaultAlone =
        (scene.FullName() == "coincident.4096" || scene.FullName() == "huge.box") && !fulcrum::testing::IsAllWanted();
    const int mostSubsteps = scene.FullName() == "coincident.4096" ? 4 : 128;
    for (const Setting& setting : PresetsAndOddSettings()) {
        if (setting.solver.substeps > mostSubsteps ||
            (isDefaultAlone && std::string_view(setting.Preset()) != "balanced"))
            continue;
        LabRun one(setting, scene.parameter, true, 1), other(setting, scene.parameter, true, 1, &two);
        scene.run(one);
        scene.run(other);
        for (const std::string& gate : one.failedConditions)
            EXPECT_TRUE(DependsOnEffort(gate)) << setting.Key() << ": " << gate;
        EXPECT_EQ(one.work.hash, other.work.hash) << setting.Key();
        ASSERT_EQ(one.observed.size(), other.observed.size()) << setting.Key();
        for (size_t i = 0; i < one.observed.size(); ++i) {
            EXPECT_TRUE(std::isfinite(one.observed[i])) << setting.Key();
            EXPECT_EQ(one.observed[i], other.observed[i]) << setting.Key();
        }
    }
}

INSTANTIATE_TEST_SUITE_P(All, ExtremeSettings, ::testing::ValuesIn(ExtremeScenes()), TestName);

}  // namespace
}  // namespace fulcrum::accuracy
