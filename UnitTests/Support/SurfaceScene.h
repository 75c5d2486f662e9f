// Bodies of every shape on meshes, height fields, planes and seams between boxes: the scene by which builds, threads
// and versions are held against each other where the mixed scene has nothing to say.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

// Hash of the poses after 240 steps with so many threads.
uint64_t HashOfSurfaceScene(uint32_t threads);

}  // namespace fulcrum::testing
