#include <Fulcrum/Samples/Runner/FileScene.h>

#include <map>

namespace fulcrum {

namespace {

void Build(SceneWorld& world) {
    Result<SceneIds> ids = AddScene(world.System(), *world.Input().description);
    if (!ids) return world.Fail(ids.GetError());
    world.ragdolls = std::move(ids.Value().ragdolls);
}

}  // namespace

Scene SceneOf(const std::string& name, const SceneDescription& description) {
    return {.name = name.c_str(),
            .description = description.description.c_str(),
            .steps = description.steps,
            .sleeping = description.settings.sleep.enabled,
            .build = Build,
            .accuracy = LargestJointGap,
            .accuracyMeaning = "largest gap of a joint",
            .accuracyUnit = "m"};
}

bool IsSceneFile(const std::string& name) { return name.ends_with(".json") || name.ends_with(".cbor"); }

Result<ExportedScene> ExportScene(const Scene& scene, const SceneInput& input) {
    SceneInput kept = input;
    kept.keepsSettings = true;
    const auto created = SceneWorld::Create(scene, kept);
    if (!created) return created.GetError();
    const SceneWorld& world = *created.Value();
    ExportedScene exported;
    SceneDescription& description = exported.description;
    description.description = scene.description;
    description.steps = scene.steps;
    description.settings = world.System().Settings();
    std::map<BodyId, int> numbers;
    for (const auto& [id, settings] : world.added) {
        numbers[id] = static_cast<int>(description.bodies.size());
        description.bodies.push_back({{}, settings});
    }
    numbers[kWorldBody] = SceneJoint::kWorld;
    for (const auto& [id, settings] : world.joined) {
        const JointSettings& common =
            std::visit([](const JointSettings& s) -> const JointSettings& { return s; }, settings);
        const auto a = numbers.find(common.bodyA), b = numbers.find(common.bodyB);
        if (a == numbers.end() || b == numbers.end())
            return Error{ErrorCode::Unsupported, "a joint holds a part of a ragdoll, which has no number in a file"};
        description.joints.push_back({{}, a->second, b->second, settings});
    }
    description.ragdolls = world.addedRagdolls;
    size_t joints = 0;
    world.Joints().Visit([&](JointId) { ++joints; });
    for (const Ragdoll& ragdoll : world.ragdolls)
        for (const JointId id : ragdoll.Joints()) joints -= world.Joints().Exists(id);
    if (joints != description.joints.size())
        return Error{ErrorCode::Unsupported, "it has joints whose settings have code, which no file has"};
    if (scene.beforeStep) exported.warnings.push_back("what the scene does while it runs");
    if (world.Listens()) exported.warnings.push_back("its contact listener");
    return exported;
}

}  // namespace fulcrum
