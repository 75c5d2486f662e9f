// Fast bodies of every convex kind in a room with a mesh floor and a turning paddle: the scene for comparing builds,
// threads and versions of continuous collision.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

// Fills the world; returns the bodies that fly.
std::vector<BodyId> BuildFastScene(TestWorld& world);

// Hash of the poses after 90 steps with so many threads. Adds a failure where a body of continuous collision has left
// the room.
uint64_t HashOfFastScene(uint32_t threads);

}  // namespace fulcrum::testing
