#include <Fulcrum/Physics/Stages/PlaceTrees.h>

#include <algorithm>

namespace fulcrum {

std::span<const bool> FindGroupsWithTrees(const BodyStore& bodies, const Islands& islands, const JointTrees& trees,
                                          ScratchArena& scratch) {
    std::span<bool> hasTrees = scratch.Allocate<bool>(islands.groups);
    std::fill(hasTrees.begin(), hasTrees.end(), false);
    for (const JointTrees::Tree& tree : trees.trees) hasTrees[GroupOf(bodies, islands, trees, tree)] = true;
    hasTrees[Islands::kLargeGroup] = false;
    return hasTrees;
}

void PlaceTrees(const BodyStore& bodies, const Islands& islands, size_t jointCount, SolverLayout& layout,
                ScratchArena& scratch) {
    layout.treesByGroup.clear();
    if (layout.trees.trees.empty()) return;
    const auto groupOf = [&](uint32_t tree) {
        return GroupOf(bodies, islands, layout.trees, layout.trees.trees[tree]);
    };
    std::span<JointPlaceInBatch> places = scratch.Allocate<JointPlaceInBatch>(jointCount);
    std::fill(places.begin(), places.end(), JointPlaceInBatch{});  // ball joints have none, nor do their trees
    for (uint32_t b = 0; b < layout.joints.count; ++b)
        for (uint32_t lane = 0; lane < static_cast<uint32_t>(layout.joints.batches[b].count); ++lane)
            places[layout.joints.batches[b].joint[lane]] = {b, lane};
    for (JointTreeSlot& slot : layout.trees.slots)
        if (slot.joint != JointTreeSlot::kNone) slot.place = places[slot.joint];
    for (JointTreeAnchor& anchor : layout.trees.anchors) anchor.place = places[anchor.joint];
    std::span<uint64_t> sorted = scratch.Allocate<uint64_t>(layout.trees.trees.size());
    for (uint32_t t = 0; t < sorted.size(); ++t) sorted[t] = uint64_t(groupOf(t)) << 32 | t;
    std::sort(sorted.begin(), sorted.end());
    for (uint64_t entry : sorted) {
        SolverGroup& group = layout.groups[entry >> 32];
        // Groups of several islands are solved without trees: their trees are parts of islands that are too large.
        if (entry >> 32 == Islands::kLargeGroup) continue;
        const JointTree tree = layout.trees.At(layout.trees.trees[entry & 0xFFFFFFFFu]);
        const auto mark = [&](const JointPlaceInBatch& place) {
            layout.joints.batches[place.batch].inTree |= 1u << place.lane;
        };
        for (const JointTreeSlot& slot : tree.slots)
            if (slot.joint != JointTreeSlot::kNone) mark(slot.place);
        for (const JointTreeAnchor& anchor : tree.anchors) mark(anchor.place);
        if (!group.HasTrees()) group.treesBegin = static_cast<uint32_t>(layout.treesByGroup.size());
        layout.treesByGroup.push_back(static_cast<uint32_t>(entry));
        group.treesEnd = static_cast<uint32_t>(layout.treesByGroup.size());
    }
}

}  // namespace fulcrum
