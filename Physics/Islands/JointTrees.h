// Finds the islands whose joints are to be solved exactly, as trees: those that carry much more than their own bodies'
// mass. Called by the BuildIslands stage where joints came or went. Serial; the result follows from the joints alone.
#pragma once

#include <Fulcrum/Constraints/Joints/JointTree.h>

#include <vector>

namespace fulcrum {

struct WorldState;

struct JointTrees {
    struct Tree {
        uint32_t slotsBegin = 0, slotsEnd = 0;
        uint32_t anchorsBegin = 0, anchorsEnd = 0;
        float load = 0;  // the largest mass that hangs on a body, itself included, in units of its own
    };
    std::vector<Tree> trees;
    std::vector<JointTreeSlot> slots;  // a tree's parents are counted from its first slot
    std::vector<JointTreeAnchor> anchors;
    uint64_t version = 0;  // of the joints that this was made from

    JointTree At(const Tree& tree) {
        return {std::span(slots).subspan(tree.slotsBegin, tree.slotsEnd - tree.slotsBegin),
                std::span(anchors).subspan(tree.anchorsBegin, tree.anchorsEnd - tree.anchorsBegin)};
    }
    size_t MemoryUsed() const {
        return trees.capacity() * sizeof(Tree) + slots.capacity() * sizeof(JointTreeSlot) +
               anchors.capacity() * sizeof(JointTreeAnchor);
    }
};

// Brings the trees in line with the colored joints.
void FindJointTrees(WorldState& world, JointTrees& trees);

}  // namespace fulcrum
