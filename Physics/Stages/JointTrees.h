// Finds the islands whose joints are to be solved exactly, as trees: those that carry much more than their own bodies'
// mass. Called by the BuildIslands stage where joints came or went. Serial; the result follows from the joints alone.
#pragma once

#include <Fulcrum/Constraints/Joints/JointTree.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/JointStore.h>

#include <vector>

namespace fulcrum {

struct JointTrees {
    struct Tree {
        uint32_t slotsBegin = 0, slotsEnd = 0;
        uint32_t blocksBegin = 0, blocksEnd = 0;
        uint32_t anchorsBegin = 0, anchorsEnd = 0;
        // The largest mass that hangs on a body, itself included, in units of its own; half of it where all bodies are
        // about as heavy.
        float load = 0;
    };
    // What iterations hold as well for less: with more substeps than the system's.
    struct Rope {
        uint32_t body;
        float substeps;  // times the system's
    };
    std::vector<Tree> trees;
    std::vector<Rope> ropes;
    std::vector<JointTreeSlot> slots;  // a tree's parents and blocks are counted from its first ones
    std::vector<JointTreeBlock> blocks;
    std::vector<JointTreeAnchor> anchors;
    uint64_t version = 0;  // of the joints that this was made from

    JointTree At(const Tree& tree) {
        return {std::span(slots).subspan(tree.slotsBegin, tree.slotsEnd - tree.slotsBegin),
                std::span(blocks).subspan(tree.blocksBegin, tree.blocksEnd - tree.blocksBegin),
                std::span(anchors).subspan(tree.anchorsBegin, tree.anchorsEnd - tree.anchorsBegin)};
    }
};

// Their matrices are of fixed size.
inline size_t HeapBytes(const JointTreeSlot&) { return 0; }
inline size_t HeapBytes(const JointTreeBlock&) { return 0; }
inline size_t HeapBytes(const JointTreeAnchor&) { return 0; }
inline size_t HeapBytes(const JointTrees& all) {
    const auto& [trees, ropes, slots, blocks, anchors, version] = all;
    return HeapBytes(trees, ropes, slots, blocks, anchors, version);
}

// Brings the trees in line with the colored joints. Reads the settings' exactJointLoad and solver.
void FindJointTrees(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                    const SystemSettings& settings, JointTrees& trees, ScratchArena& scratch);

}  // namespace fulcrum
