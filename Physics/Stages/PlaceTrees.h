// Assigns trees of joints to the solver's groups. Called by BuildIslands.
#pragma once

#include <Fulcrum/Physics/Stages/FindIslands.h>

namespace fulcrum {

// By group: whether it is solved with trees. Groups of several islands are not: their trees are parts of islands that
// are too large.
std::span<const bool> FindGroupsWithTrees(const BodyStore& bodies, const Islands& islands, const JointTrees& trees,
                                          ScratchArena& scratch);

// Assigns the trees to their groups, and sets the locations of their joints' parts.
void PlaceTrees(const BodyStore& bodies, const Islands& islands, size_t jointCount, SolverLayout& layout,
                ScratchArena& scratch);

}  // namespace fulcrum
