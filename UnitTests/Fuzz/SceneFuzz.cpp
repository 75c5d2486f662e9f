// Scene files: what is accepted, JSON or CBOR, makes a scene that steps, and is written to JSON that reads the same.
// Ragdoll files likewise.
#ifdef FULCRUM_HAS_ASSETS

#include <Fulcrum/Assets/RagdollJson.h>
#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <nlohmann/json.hpp>

#include <string>

namespace fulcrum::testing {

namespace {

// Scenes may name files; those of this machine are none of its business.
constexpr const char* kFolder = "/nowhere";

void Use(const Result<SceneDescription>& scene) {
    if (!scene) {
        Promise(!scene.GetError().message.empty(), "an error says what is wrong");
        return;
    }
    const auto written = SceneToJson(scene.Value());
    if (written) {
        const auto again = SceneFromJson(written.Value(), kFolder);
        Promise(static_cast<bool>(again), "what was written can be read");
        Promise(SceneToJson(again.Value()).Value() == written.Value(), "what was read is written the same");
    }
    const auto system = PhysicsSystem::Create(scene.Value().settings);
    if (!system || !AddScene(*system.Value(), scene.Value())) return;
    for (int step = 0; step < 2; ++step) static_cast<void>(system.Value()->Update(scene.Value().dt));
    system.Value()->VisitBodies(
        [&](BodyId id) { Promise(IsFinite(system.Value()->Bodies().GetPose(id).position), "bodies stay finite"); });
}

std::string TextOf(std::span<const uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

void RunScene(std::span<const uint8_t> bytes) { Use(SceneFromJson(TextOf(bytes), kFolder)); }
void RunCbor(std::span<const uint8_t> bytes) { Use(SceneFromCbor(TextOf(bytes), kFolder)); }

void RunRagdoll(std::span<const uint8_t> bytes) {
    const auto json = nlohmann::ordered_json::parse(bytes, nullptr, false);
    const auto ragdoll = RagdollFromJson(json);
    if (!ragdoll) {
        Promise(!ragdoll.GetError().message.empty(), "an error says what is wrong");
        return;
    }
    const auto written = RagdollToJson(ragdoll.Value());
    if (written) {
        const auto again = RagdollFromJson(written.Value());
        Promise(static_cast<bool>(again), "what was written can be read");
        Promise(RagdollToJson(again.Value()).Value() == written.Value(), "what was read is written the same");
    }
    TestWorld world;
    if (auto created = Ragdoll::Create(world.System(), ragdoll.Value(), {})) world.Steps(2);
    Promise(world.AllFinite(), "bodies stay finite");
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

std::vector<FuzzBytes> SeedsOfCbor() {
    std::vector<FuzzBytes> seeds;
    for (const FuzzBytes& seed : SeedsOfScenes())
        seeds.push_back(nlohmann::ordered_json::to_cbor(nlohmann::ordered_json::parse(seed)));
    return seeds;
}

std::vector<FuzzBytes> SeedsOfRagdolls() {
    const std::string text = R"({"parts": [
        {"name": "pelvis", "body": {"shape": {"kind": "Capsule", "halfHeight": 0.08, "radius": 0.12}}},
        {"name": "torso", "parent": "pelvis", "body": {"shape": {"kind": "Box", "halfExtents": [0.2, 0.3, 0.1]},
            "position": [0, 0.4, 0]},
         "joint": {"kind": "SwingTwist", "anchorA": {"point": [0, 0.1, 0], "axis": [0, 1, 0]},
                   "twist": {"limited": true, "limits": {"min": -0.3, "max": 0.3}}}},
        {"name": "head", "parent": "torso", "body": {"shape": {"kind": "Sphere", "radius": 0.1}, "position": [0, 0.9, 0]},
         "joint": {"kind": "Cone", "anchorA": {"point": [0, 0.75, 0]}, "halfAngle": 0.5}}]})";
    EXPECT_TRUE(RagdollFromJson(nlohmann::ordered_json::parse(text)));
    return {FuzzBytes(text.begin(), text.end())};
}

}  // namespace

const FuzzTarget kCborTarget{"scene-cbor", RunCbor, SeedsOfCbor, 1500};
const FuzzTarget kRagdollTarget{"ragdoll", RunRagdoll, SeedsOfRagdolls, 1500};
const FuzzTarget kSceneTarget{"scene", RunScene, SeedsOfScenes, 1500};

}  // namespace fulcrum::testing

#endif
