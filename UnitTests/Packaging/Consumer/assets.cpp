// A scene from text, by the installed Fulcrum::Assets.
#include <Fulcrum/Assets/SceneFile.h>

#include <cstdio>

int main() {
    const auto scene = fulcrum::SceneFromJson(R"({"fulcrumScene": 1, "bodies": [
        {"shape": {"kind": "Plane"}, "motion": "Static"},
        {"name": "crate", "shape": {"kind": "Box", "halfExtents": [0.5, 0.5, 0.5]}, "position": [0, 2, 0]}]})");
    if (!scene) return std::puts(scene.GetError().message.c_str()), 1;
    const auto system = fulcrum::PhysicsSystem::Create(scene.Value().settings).Value();
    const auto ids = fulcrum::AddScene(*system, scene.Value());
    if (!ids) return std::puts(ids.GetError().message.c_str()), 1;
    for (int i = 0; i < 120; ++i)
        if (!system->Update(1.0 / 60)) return 1;
    std::printf("%s: height %.2f m\n", scene.Value().bodies[1].name.c_str(),
                system->Bodies().GetPose(ids.Value().bodies[1]).position.y());
    return 0;
}
