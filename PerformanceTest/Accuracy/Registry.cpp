#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>

#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/PerformanceTest/Accuracy/UserScene.h>

#include <algorithm>

namespace fulcrum::accuracy {

const std::vector<LabScene>& AllLabScenes() {
    static const std::vector<LabScene> scenes = [] {
        std::vector<LabScene> all;
        for (const auto family : {FreeMotionScenes, PendulumScenes, SlidingScenes, BouncingScenes, RestingScenes,
                                  DriveScenes, LoadScenes, ChainScenes, LinkageScenes, HangingScenes, FastScenes,
                                  PlaceScenes, OverlapScenes, SurfaceScenes, DisputeScenes, InputScenes})
            for (const LabScene& scene : family()) all.push_back(scene);
        std::stable_sort(all.begin(), all.end(),
                         [](const LabScene& a, const LabScene& b) { return a.isExtreme < b.isExtreme; });
        return all;
    }();
    return scenes;
}

std::vector<const LabScene*> FindLabScenes(const std::string& name) {
    std::vector<const LabScene*> found;
    for (const LabScene& scene : AllLabScenes())
        if (scene.FullName() == name || scene.name == name) found.push_back(&scene);
    if (const LabScene* users = FindUserScene(name); users && found.empty()) found.push_back(users);
    return found;
}

std::vector<std::string> LabSceneNames() {
    std::vector<std::string> names;
    for (const LabScene& scene : AllLabScenes())
        for (const std::string& name : {std::string(scene.name), scene.FullName()})
            if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    return names;
}

}  // namespace fulcrum::accuracy
