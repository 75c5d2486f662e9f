// Scenes from files (Assets/SceneFile.h) as scenes of the runner, and scenes of the runner as files. One thread.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fulcrum {

// A scene that creates SceneInput::description. Its accuracy figure is the largest gap of a joint. The scene refers to
// the name and the description, which must outlive it.
Scene SceneOf(const std::string& name, const SceneDescription& description);

// Whether a scene's name on the command line is that of a file.
bool IsSceneFile(const std::string& name);

struct ExportedScene {
    SceneDescription description;
    std::vector<std::string> warnings;  // of what the file does not have
};
// What a scene creates, and its settings with those of `input`. Errors: those of SceneWorld::Create; Unsupported (a
// joint whose settings have code).
Result<ExportedScene> ExportScene(const Scene& scene, const SceneInput& input);

}  // namespace fulcrum
