// Every scene of the accuracy lab at the finest setting of the short grid is within its bound, which is stated where
// the scene is; the list is complete.
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>
#include <Fulcrum/UnitTests/Accuracy/LabSceneNames.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <set>

namespace fulcrum::accuracy {

namespace {

Setting FinestQuick(const LabScene& scene) {
    const std::vector<Setting> grid = QuickGrid(scene.influences);
    return *std::max_element(grid.begin(), grid.end(), [](const Setting& a, const Setting& b) {
        return std::pair(a.PassesPerSecond(), a.rate) < std::pair(b.PassesPerSecond(), b.rate);
    });
}

class LabSceneTest : public ::testing::TestWithParam<LabScene> {
protected:
    static nlohmann::ordered_json Baseline() {
        std::ifstream file(FULCRUM_SOURCE_DIR "/PerformanceTest/Accuracy/quick.json");
        return nlohmann::ordered_json::parse(file).at("scenes");
    }
};

// The run itself is the lab's: ./fulcrum test runs its short grid and holds every error to these.
TEST_P(LabSceneTest, IsExactAtTheFinestQuickSetting) {
    static const nlohmann::ordered_json kBaseline = Baseline();
    const LabScene& scene = GetParam();
    const Setting setting = FinestQuick(scene);
    const nlohmann::ordered_json run = kBaseline.at(scene.FullName()).at(setting.Key());
    ASSERT_FALSE(run.at("errors").empty());
    EXPECT_LT(run.at("errors").front().get<double>(), scene.testBound) << setting.Key();
    for (const auto& [name, value] : run.at("errors").items()) EXPECT_GE(value.get<double>(), 0) << name;
    const nlohmann::ordered_json failed = run.value("failed_conditions", nlohmann::ordered_json::array());
    for (const nlohmann::ordered_json& condition : failed) EXPECT_NE(condition, "every pose is finite");
}

INSTANTIATE_TEST_SUITE_P(All, LabSceneTest, ::testing::ValuesIn(AllLabScenes()), TestName);

TEST(LabRegistry, HasEveryScene) {
    std::set<std::string> names;
    std::set<std::string> fullNames;
    for (const LabScene& scene : AllLabScenes()) {
        names.insert(scene.name);
        EXPECT_TRUE(fullNames.insert(scene.FullName()).second) << scene.FullName() << " twice";
        EXPECT_GT(scene.testBound, 0) << scene.FullName();
        EXPECT_NE(scene.run, nullptr);
    }
    EXPECT_EQ(
        names,
        (std::set<std::string>{
            "projectile",    "free_rotation",  "pendulum",    "point_pendulum", "incline",      "friction_isotropy",
            "slide_to_roll", "rolling",        "restitution", "bouncing_field", "resting_cube", "weight",
            "bins",          "spring",         "motor",       "gear_pulley",    "momentum",     "heavy_on_light",
            "four_bar",      "seven_bars",     "stewart",     "hung_chain",     "rope_of_rods", "held_gyroscope",
            "cone",          "heavy_chain",    "long_chain",  "tall_stack",     "tiny",         "huge",
            "bullet",        "fast_spin",      "far_away",    "time_step",      "overlap",      "coincident",
            "degenerate",    "internal_edges", "thin",        "contradictory",  "singular",     "bad_input",
            "soak"}));
}

TEST(LabRegistry, FindsScenesByTheirNameAndByTheirFullName) {
    EXPECT_EQ(FindLabScenes("incline").size(), 2u);
    ASSERT_EQ(FindLabScenes("incline.stick").size(), 1u);
    EXPECT_STREQ(FindLabScenes("incline.stick")[0]->variant, "stick");
    EXPECT_TRUE(FindLabScenes("inclin").empty());
}

TEST(LabGrid, HasThePresetsAndEachSettingOnce) {
    const Influences all{.contacts = true, .joints = true};
    for (const std::vector<Setting>& grid : {QuickGrid(all), FullGrid(all), FullGrid(all, true)}) {
        std::set<std::string> keys, presets;
        for (const Setting& setting : grid) {
            EXPECT_TRUE(keys.insert(setting.Key()).second) << setting.Key();
            presets.insert(setting.Preset());
        }
        EXPECT_EQ(presets, (std::set<std::string>{"", "fast", "balanced", "accurate", "reference"}));
    }
    EXPECT_GE(QuickGrid(all).size(), 10u);
    EXPECT_LE(QuickGrid(all).size(), 14u);
    // 6 steps x 5 substeps x 6 velocity x 4 position iterations of two families, a part of two more, and a preset.
    EXPECT_EQ(FullGrid(all).size(), 2u * 720 + 2 * 60 + 1);
    // 4 x 3 x 3 x 3, and the presets with 2 and 64 substeps.
    EXPECT_EQ(FullGrid(all, true).size(), 2u * 108 + 2 * 24 + 2);
}

TEST(LabGrid, LeavesOutWhatDoesNotMatter) {
    EXPECT_EQ(FullGrid({}).size(), 6u);  // time steps
    EXPECT_EQ(FullGrid({.timeStep = false}).size(), 1u);
    for (const Setting& setting : QuickGrid({.joints = true})) EXPECT_NE(setting.family, Family::Libccd);
    for (const Setting& setting : QuickGrid({.contacts = true})) EXPECT_NE(setting.family, Family::NoTrees);
}

}  // namespace
}  // namespace fulcrum::accuracy
