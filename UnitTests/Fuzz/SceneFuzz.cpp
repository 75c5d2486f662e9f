// Scene files: JSON that is accepted makes a scene that steps, and is written to JSON that reads the same.
#ifdef FULCRUM_HAS_ASSETS

#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <string>

namespace fulcrum::testing {

namespace {

void RunScene(std::span<const uint8_t> bytes) {
    const std::string text(bytes.begin(), bytes.end());
    // Scenes may name files; those of this machine are none of its business.
    const auto scene = SceneFromJson(text, "/nowhere");
    if (!scene) {
        Promise(!scene.GetError().message.empty(), "an error says what is wrong");
        return;
    }
    const auto written = SceneToJson(scene.Value());
    if (written) {
        const auto again = SceneFromJson(written.Value(), "/nowhere");
        Promise(static_cast<bool>(again), "what was written can be read");
        Promise(SceneToJson(again.Value()).Value() == written.Value(), "what was read is written the same");
    }
    const auto system = PhysicsSystem::Create(scene.Value().settings);
    if (!system || !AddScene(*system.Value(), scene.Value())) return;
    for (int step = 0; step < 2; ++step) static_cast<void>(system.Value()->Update(scene.Value().dt));
    system.Value()->VisitBodies(
        [&](BodyId id) { Promise(IsFinite(system.Value()->Bodies().GetPose(id).position), "bodies stay finite"); });
}

std::vector<FuzzBytes> SeedsOfScenes() {
    const std::string texts[] = {
        R"({"fulcrumScene": 1})",
        R"({"fulcrumScene": 1, "steps": 3, "settings": {"gravity": [0, -9.81, 0], "solver": {"substeps": 8}},
            "shapes": {"crate": {"kind": "Box", "halfExtents": [0.5, 0.5, 0.5]}},
            "bodies": [{"name": "floor", "shape": {"kind": "Plane"}, "motion": "Static"},
                       {"name": "lid", "shape": "crate", "position": [0, 2, 0], "mass": 3, "layer": 2}],
            "joints": [{"kind": "Hinge", "bodyA": "world", "bodyB": "lid",
                        "anchorA": {"point": [0, 2, 0.5], "axis": [1, 0, 0]}}]})",
        R"({"fulcrumScene": 1, "bodies": [
            {"shape": {"kind": "Capsule", "halfHeight": 1, "radius": 0.5}, "position": [1e3, 2, -1], "linearVelocity": [1, 2, 3]},
            {"shape": {"kind": "ConvexHull", "points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]]}, "material": {"friction": 1}},
            {"shape": {"kind": "Compound", "children": [{"shape": {"kind": "Sphere", "radius": 1}}]}}]})",
    };
    std::vector<FuzzBytes> seeds;
    for (const std::string& text : texts) {
        EXPECT_TRUE(SceneFromJson(text)) << SceneFromJson(text).GetError().message;
        seeds.emplace_back(text.begin(), text.end());
    }
    return seeds;
}

}  // namespace

const FuzzTarget kSceneTarget{"scene", RunScene, SeedsOfScenes, 1500};

}  // namespace fulcrum::testing

#endif
