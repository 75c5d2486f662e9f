// Finds the mechanisms whose joints are solved by the direct tree solver: those that carry much more than their own
// bodies' mass, and those with a joint that has been strained (JointStrain.h). Called by the BuildIslands stage if
// joints were added or removed, or began to be strained. Serial; the result depends only on the joints.
#pragma once

#include <Fulcrum/Constraints/Joints/JointTree.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/JointStore.h>

namespace fulcrum {

struct JointTrees {
    struct Tree {
        uint32_t slotsBegin = 0, slotsEnd = 0;
        uint32_t blocksBegin = 0, blocksEnd = 0;
        uint32_t anchorsBegin = 0, anchorsEnd = 0;
        // The largest ratio of the mass of a body's subtree, itself included, to its own mass; halved if all masses are
        // similar.
        float load = 0;
    };
    // An island that iterations with more substeps solve as well at lower cost.
    struct Rope {
        uint32_t body;
        float substeps;  // in multiples of the system's
    };
    Array<Tree> trees;
    Array<Rope> ropes;
    Array<JointTreeSlot> slots;  // parents and blocks are relative to the tree's first ones
    Array<JointTreeBlock> blocks;
    Array<JointTreeAnchor> anchors;
    uint64_t version = 0, strainVersion = 0;  // versions of the joints from which this was computed

    JointTree At(const Tree& tree) {
        return {std::span(slots).subspan(tree.slotsBegin, tree.slotsEnd - tree.slotsBegin),
                std::span(blocks).subspan(tree.blocksBegin, tree.blocksEnd - tree.blocksBegin),
                std::span(anchors).subspan(tree.anchorsBegin, tree.anchorsEnd - tree.anchorsBegin)};
    }
};

// Matrices have fixed size.
inline size_t HeapBytes(const JointTreeSlot&) { return 0; }
inline size_t HeapBytes(const JointTreeBlock&) { return 0; }
inline size_t HeapBytes(const JointTreeAnchor&) { return 0; }
inline size_t HeapBytes(const JointTrees& all) {
    const auto& [trees, ropes, slots, blocks, anchors, version, strainVersion] = all;
    return HeapBytes(trees, ropes, slots, blocks, anchors, version, strainVersion);
}

// Updates the trees from the colored joints. Reads the settings' exactJointLoad and solver.
void FindJointTrees(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                    const SystemSettings& settings, JointTrees& trees, ScratchArena& scratch);

}  // namespace fulcrum
