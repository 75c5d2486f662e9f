// The documents' data about the performance scenes (Docs/figures.json) match the scenes.
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <set>
#include <string>

namespace fulcrum {
namespace {

nlohmann::json Figures() {
    std::ifstream file(FULCRUM_SOURCE_DIR "/Docs/figures.json");
    return nlohmann::json::parse(file);
}

TEST(Figures, AreThoseOfThePerformanceScenes) {
    std::set<std::string> told, known;
    const nlohmann::json figures = Figures();
    for (const nlohmann::json& scene : figures["scenes"]) told.insert(scene["name"].get<std::string>());
    for (const Scene* scene : AllScenes())
        if (scene->kind == SceneKind::Performance) known.insert(scene->name);
    EXPECT_EQ(told, known);
}

// 99 of the 100 balls in each of 100 columns hang on one above; the 99 rows that move are joined across by 99 joints
// each.
TEST(Figures, JointGridHasAsManyJoints) {
    const auto world = SceneWorld::Create(*FindScene("joint_grid"), {}, nullptr);
    ASSERT_TRUE(world);
    uint32_t count = 0;
    world.Value()->Joints().Visit([&](JointId) { ++count; });
    EXPECT_EQ(count, 100u * 99u + 99u * 99u);
    const nlohmann::json figures = Figures();
    for (const nlohmann::json& scene : figures["scenes"])
        if (scene["name"] == "joint_grid") {
            EXPECT_EQ(scene["joints"], count);
        }
}

}  // namespace
}  // namespace fulcrum
