// Checks the whole structure of a BoundsTree, in release builds too. For tests.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <cstdio>
#include <cstdlib>

namespace fulcrum {

namespace {
void Require(bool condition, const char* what) {
    if (condition) return;
    std::fprintf(stderr, "BoundsTree: %s\n", what);
    std::abort();
}
}  // namespace

void BoundsTree::Validate() const {
    uint32_t known = 0;
    for (uint32_t id = 0; id < places_.size(); ++id) known += Contains(id);
    Require(known == size_, "the count of leaves is wrong");
    if (size_ == 0) return;
    uint32_t nodes = 0, leaves = 0;
    ValidateNode(kRoot, 0, nodes, leaves);
    Require(leaves == size_, "a leaf cannot be reached, or is reached twice");
    for (uint32_t node = freeNode_; node != kNoNode; node = nodes_[node].parent) ++nodes;
    Require(nodes == nodeCount_, "a node is lost, or used twice");
}

void BoundsTree::ValidateNode(uint32_t node, int depth, uint32_t& nodes, uint32_t& leaves) const {
    Require(++nodes <= nodeCount_ && depth < kMaxDepth, "the tree is too deep, or has a cycle");
    const Node& n = nodes_[node];
    Require((n.leaves & n.inner) == 0, "a slot holds both a leaf and a node");
    Require((n.stale & ~n.inner) == 0, "a slot without a node is noted as stale");
    for (int slot = 0; slot < kWidth; ++slot) {
        const uint32_t bit = 1u << slot;
        const Packed box = SlotBox(node, slot);
        if ((n.leaves & bit) != 0) {
            ++leaves;
            Require(
                n.child[slot] < places_.size() && places_[n.child[slot]] == node * kWidth + static_cast<uint32_t>(slot),
                "a leaf is not where its id says");
            Require(IsValid(Unpack(box)), "a leaf's box is not a box");
        } else if ((n.inner & bit) != 0) {
            const uint32_t child = n.child[slot];
            Require(child < nodeCount_ && nodes_[child].parent == node && nodes_[child].parentSlot == slot,
                    "a node does not know its parent");
            Require(nodes_[child].stale == 0 || (n.stale & bit) != 0, "a stale slot is not noted above");
            const Packed inside = Union(nodes_[child]);
            for (int lane : {0, 1, 2, 4, 5, 6})
                Require(box.lane[lane] <= inside.lane[lane], "a node's box does not contain what is below it");
            ValidateNode(child, depth + 1, nodes, leaves);
        } else {
            for (int lane : {0, 1, 2, 4, 5, 6})
                Require(box.lane[lane] == EmptyBox().lane[lane], "an empty slot's box is not empty");
        }
    }
}

}  // namespace fulcrum
