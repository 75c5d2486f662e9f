// The JSON Schema (draft 2020-12) of scene files, from the fields that are read and written. Pure function.
#pragma once

#include <string>

namespace fulcrum {

// What Assets/scene.schema.json contains.
std::string SceneSchema();

}  // namespace fulcrum
