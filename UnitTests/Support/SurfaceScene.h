// Bodies of every shape on meshes, height fields, planes and seams between boxes: the scene for comparing builds,
// threads and versions of contacts with surfaces.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

// Fills the world; returns a kinematic body.
BodyId BuildSurfaceScene(TestWorld& world);

// Hash of the poses after 240 steps with so many threads.
uint64_t HashOfSurfaceScene(uint32_t threads);

}  // namespace fulcrum::testing
