// The bulk build of a BoundsTree: top down, splitting at medians along the longest axis of the centres, at multiples of a
// power of eight, so that all nodes but the last of each height are full.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <algorithm>
#include <bit>
#include <limits>

namespace fulcrum {

namespace {
constexpr int kIdLane = 3;
}

// All leaves in the order of the nodes' memory: mostly the spatial order of the last build.
void BoundsTree::GatherLeaves() {
    gathered_.resize(size_);
    uint32_t count = 0;
    for (uint32_t node = 0; node < nodeCount_; ++node) {
        for (uint32_t leaves = nodes_[node].leaves; leaves != 0; leaves &= leaves - 1) {
            const int slot = std::countr_zero(leaves);
            Packed& leaf = gathered_[count++];
            leaf = SlotBox(node, slot);
            leaf.lane[kIdLane] = std::bit_cast<float>(nodes_[node].child[slot]);
        }
    }
}

void BoundsTree::Rebuild() {
    if (size_ == 0) return;
    GatherLeaves();
    nodeCount_ = 0;
    freeNode_ = kNoNode;
    pendingHeight_ = pendingCount_ = changesSinceOptimize_ = 0;
    area_ = debt_ = 0;
    BuildNode(AllocateNode(), 0, size_, kPendingSlot);
    builtArea_ = area_;
}

// Fills `slots` slots of a new node with the gathered leaves [first, first + count). Returns the box around them.
BoundsTree::Packed BoundsTree::BuildNode(uint32_t node, uint32_t first, uint32_t count, int slots) {
    Wide<8> total(std::numeric_limits<float>::infinity());
    Packed box;
    int slot = 0;
    if (count <= static_cast<uint32_t>(slots)) {
        for (uint32_t i = first; i < first + count; ++i) {
            SetLeaf(node, slot++, std::bit_cast<uint32_t>(gathered_[i].lane[kIdLane]), gathered_[i]);
            total = Min(total, Wide<8>::Load(gathered_[i].lane));
        }
        total.Store(box.lane);
        return box;
    }
    uint64_t capacity = kWidth;
    while (capacity * static_cast<uint64_t>(slots) < count) capacity *= kWidth;
    total.Store(box.lane);
    BuildChildren(node, first, count, static_cast<uint32_t>(capacity), slot, box);
    return box;
}

// Halves the range until each part fits a child of the given capacity, and puts the children into the next slots.
void BoundsTree::BuildChildren(uint32_t node, uint32_t first, uint32_t count, uint32_t capacity, int& slot, Packed& total) {
    if (count > capacity) {
        const uint32_t units = (count - 1) / capacity + 1;
        const uint32_t left = units / 2 * capacity;
        SplitAt(first, count, left);
        BuildChildren(node, first, left, capacity, slot, total);
        BuildChildren(node, first + left, count - left, capacity, slot, total);
        return;
    }
    Packed box = gathered_[first];
    if (count == 1) {
        SetLeaf(node, slot++, std::bit_cast<uint32_t>(box.lane[kIdLane]), box);
    } else {
        const uint32_t child = AllocateNode();
        box = BuildNode(child, first, count, kWidth);
        SetInner(node, slot++, child, box);
    }
    Min(Wide<8>::Load(total.lane), Wide<8>::Load(box.lane)).Store(total.lane);
}

// Reorders a range so that its first `left` leaves have the smaller centres along the axis on which the centres lie
// farthest apart.
void BoundsTree::SplitAt(uint32_t first, uint32_t count, uint32_t left) {
    const auto centre = [](const Packed& leaf, int axis) { return 0.5f * leaf.lane[axis] - 0.5f * leaf.lane[4 + axis]; };
    float lowest[3], highest[3];
    for (int axis = 0; axis < 3; ++axis) lowest[axis] = highest[axis] = centre(gathered_[first], axis);
    for (uint32_t i = first + 1; i < first + count; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            const float c = centre(gathered_[i], axis);
            lowest[axis] = Min(lowest[axis], c);
            highest[axis] = Max(highest[axis], c);
        }
    }
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (highest[axis] - lowest[axis] > highest[longest] - lowest[longest]) longest = axis;
    const auto begin = gathered_.begin() + first;
    std::nth_element(begin, begin + left, begin + count, [&](const Packed& a, const Packed& b) {
        return centre(a, longest) < centre(b, longest);
    });
}

}  // namespace fulcrum
