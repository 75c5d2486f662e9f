// The list of all scenes. Used by the runner, the benchmark and the tests; any thread.
#pragma once

#include <Fulcrum/Samples/Scenes/Scene.h>

#include <span>
#include <string_view>

namespace fulcrum {

// Performance scenes first, each kind in the order of Scenes.cpp.
std::span<const Scene* const> AllScenes();
// Null where no scene has the name.
const Scene* FindScene(std::string_view name);

// Not in the list: drops SceneInput::count bodies of SceneInput::shape onto a heap between low walls.
namespace DropScene {
extern const Scene kScene;
}
// Not in the list: drops them over SceneInput::ground, a mesh that stands on y = 0.
namespace DropOntoScene {
extern const Scene kScene;
}

}  // namespace fulcrum
