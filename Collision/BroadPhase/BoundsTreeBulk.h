// Updates and pair searches of most leaves of a BoundsTree at once, node by node: if nearly everything moved, far
// cheaper per leaf than one query each. Used by UpdateBounds and FindPairs, in parallel over ranges of nodes. Allocates
// nothing.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

namespace fulcrum {

inline void BoundsTree::LimitOf(const Packed& box, float (&limit)[6]) {
    for (int axis = 0; axis < 3; ++axis) {
        limit[axis] = -box.lane[4 + axis];
        limit[3 + axis] = -box.lane[axis];
    }
}

template <class BoundsOf>
void BoundsTree::UpdateLeaves(uint32_t begin, uint32_t end, BoundsOf&& boundsOf) {
    for (uint32_t node = begin; node < end; ++node) {
        for (uint32_t leaves = nodes_[node].leaves; leaves != 0; leaves &= leaves - 1) {
            const int slot = std::countr_zero(leaves);
            const Bounds& bounds = boundsOf(nodes_[node].child[slot]);
            SetSlotBox(node, slot, Pack(bounds));
        }
    }
}

template <class Visitor>
void BoundsTree::VisitPairs(uint32_t begin, uint32_t end, Visitor&& visit) const {
    for (uint32_t own = begin; own < end; ++own) {
        const Node& group = nodes_[own];
        if (group.leaves == 0) continue;
        float limit[6];
        LimitOf(Union(group), limit);
        uint32_t stack[kMaxStack];
        int top = 0;
        stack[top++] = kRoot;
        while (top > 0) {
            const uint32_t index = stack[--top];
            const Node& node = nodes_[index];
            if (index < own && node.inner == 0) continue;
            const uint32_t hits = TestSlots(node, limit);
            for (uint32_t inner = hits & node.inner; inner != 0; inner &= inner - 1)
                stack[top++] = node.child[std::countr_zero(inner)];
            if (index < own) continue;
            for (uint32_t leaves = hits & node.leaves; leaves != 0; leaves &= leaves - 1) {
                const int slot = std::countr_zero(leaves);
                float leaf[6];
                LimitOf(SlotBox(index, slot), leaf);
                uint32_t overlaps = TestSlots(group, leaf) & group.leaves;
                if (index == own) overlaps &= (1u << slot) - 1u;
                for (; overlaps != 0; overlaps &= overlaps - 1)
                    visit(node.child[slot], group.child[std::countr_zero(overlaps)]);
            }
        }
    }
}

template <class Visitor>
void BoundsTree::VisitGroups(uint32_t begin, uint32_t end, Visitor&& visit) const {
    for (uint32_t node = begin; node < end; ++node) {
        uint32_t ids[kWidth];
        size_t count = 0;
        for (uint32_t leaves = nodes_[node].leaves; leaves != 0; leaves &= leaves - 1)
            ids[count++] = nodes_[node].child[std::countr_zero(leaves)];
        if (count > 0) visit(Unpack(Union(nodes_[node])), std::span<const uint32_t>(ids, count));
    }
}

}  // namespace fulcrum
