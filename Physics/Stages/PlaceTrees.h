// Which groups of the solver solve which trees of joints. Called by BuildIslands.
#pragma once

#include <Fulcrum/Physics/Stages/FindIslands.h>

namespace fulcrum {

// By group: whether it is solved with trees. Groups of several islands are not: theirs are parts of islands that are
// too large.
std::span<const bool> FindGroupsWithTrees(const BodyStore& bodies, const Islands& islands, const JointTrees& trees,
                                          ScratchArena& scratch);

// Hands the trees to the groups that solve them, and tells them where the parts of their joints are.
void PlaceTrees(const BodyStore& bodies, const Islands& islands, size_t jointCount, SolverLayout& layout,
                ScratchArena& scratch);

}  // namespace fulcrum
