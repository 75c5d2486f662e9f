// Dynamic bounding-volume hierarchy of AABBs, eight to a node. The broad phase keeps one for moving and one for static
// colliders and one for sensors. Queries may run on any number of threads at once; everything that is not const is
// serial. The order in which leaves are found depends on the tree's shape, the set of leaves does not: callers that
// need an order sort.
//
// Leaves are changed by Insert, Update and Remove; Optimize, once a step, keeps the tree efficient:
// - Insert appends to a tree of recent insertions, packed eight by eight in their order, which hangs in the last slot
//   of the root. Colliders that are created together mostly lie together, so even this tree is efficient.
// - Update writes the leaf's box and enlarges its ancestors as far as needed; ancestors that could shrink are only
//   marked stale.
// - Remove empties the leaf's slot and frees nodes that became empty.
// - Optimize refits the stale boxes, and rebuilds the tree if that pays off.
//
// If most leaves change at once, UpdateLeaves and VisitPairs are cheaper per leaf. Both work on ranges of nodes, which
// threads may share.
#pragma once

#include <Fulcrum/Collision/Shapes/ParallelLoop.h>
#include <Fulcrum/Math/Bounds.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Wide.h>

#include <bit>
#include <cstdint>
#include <span>

namespace fulcrum {

class TreeRay;

class BoundsTree {
public:
    // Ids are the caller's, dense from 0: memory grows with the largest. Bounds have lower <= upper (asserted).
    // Coordinates are clamped to +-kFarthest, and boxes with NaN are found by no query.
    static constexpr float kFarthest = 1e38f;
    void Insert(uint32_t id, const Bounds& bounds);  // id is not in the tree
    void Remove(uint32_t id);                        // id is in the tree
    void Update(uint32_t id, const Bounds& bounds);  // id is in the tree

    bool Contains(uint32_t id) const { return id < places_.size() && places_[id] != kNowhere; }
    uint32_t Size() const { return size_; }
    Bounds GetBounds(uint32_t id) const;  // id is in the tree

    // Once a step: refits the ancestors of leaves that changed. Rebuilds the tree when the extra cost of queries due to
    // its looser boxes since the last rebuild has reached the cost of a rebuild. queries: that will follow, before the
    // next call. Without: one for each Insert and Update since the last.
    void Optimize() { Optimize(changesSinceOptimize_); }
    void Optimize(uint32_t queries, const ParallelLoop& parallel = {});
    // Whether most leaves were inserted since the last rebuild, so that queries cost up to twice as much.
    bool IsMostlyPending() const { return pendingCount_ > kWidth && pendingCount_ > size_ / 2; }

    // Nodes are 0 .. NodeCount() - 1; any may have no leaves. The functions over ranges of nodes are defined in
    // BoundsTreeBulk.h.
    uint32_t NodeCount() const { return nodeCount_; }
    // Writes boundsOf(uint32_t id) into all leaves of the nodes begin .. end - 1. Disjoint ranges may be written in
    // parallel. Until all nodes are written and NoteUpdated was called, only NodeCount may be called.
    template <class BoundsOf>
    void UpdateLeaves(uint32_t begin, uint32_t end, BoundsOf&& boundsOf);
    // After UpdateLeaves: the number of changed leaves. The next Optimize, which must follow before any query, refits
    // their ancestors.
    void NoteUpdated(uint32_t changed);

    // Rebuilds the whole tree, top down, each node full except for the last ones; leaves that are large compared to the
    // whole, such as floors, hang right below the root. The tree does not depend on `parallel`.
    void Rebuild(const ParallelLoop& parallel = {});

    // Removes all leaves and keeps the memory.
    void Clear();
    // Allocates all that a tree of ids below `ids` needs.
    void Reserve(size_t ids);
    // Allocates what Insert needs for `count` more leaves of ids below `ids`.
    void ReserveInsertions(uint32_t count, size_t ids);

    // Calls visit(uint32_t id) for every leaf whose bounds overlap `bounds` (touching counts; infinite bounds are
    // allowed). Allocates nothing. The visitor must not change the tree.
    template <class Visitor>
    void Query(const Bounds& bounds, Visitor&& visit) const;

    // Calls visit(uint32_t id, uint32_t other) once for each pair of overlapping leaves, in the call whose range holds
    // the lower-numbered node of the two: ranges that together cover all nodes find all pairs.
    template <class Visitor>
    void VisitPairs(uint32_t begin, uint32_t end, Visitor&& visit) const;
    // Calls visit(const Bounds& all, std::span<const uint32_t> ids) for the leaves of each node among begin .. end - 1
    // that has any; `all` contains them.
    template <class Visitor>
    void VisitGroups(uint32_t begin, uint32_t end, Visitor&& visit) const;

    // The next two are defined in BoundsTreeCasts.h, which callers include. Calls visit(uint32_t id) for the leaves
    // that the ray, or moving box, hits within `maxFraction` of its displacement, those of nodes that are hit earlier
    // first. The visitor may lower maxFraction as it finds hits; below 0 ends the search.
    template <class Visitor>
    void CastRay(const TreeRay& ray, float& maxFraction, Visitor&& visit) const;
    // The same for the leaves within `maxDistance` m of a box, nearer nodes first.
    template <class Visitor>
    void VisitNear(const Bounds& box, const float& maxDistance, Visitor&& visit) const;

    // A box around all leaves, tight after Optimize or Rebuild. Empty without leaves.
    Bounds TotalBounds() const;

    // The nodes that a random line through TotalBounds() is expected to visit (surface area heuristic); 0 without
    // leaves.
    float Cost() const;

    // Bytes allocated.
    size_t MemoryUsed() const;

    // Aborts if the structure is broken: a leaf unreachable or reached twice, a parent that does not contain a child, a
    // wrong count. For tests; reads the whole tree.
    void Validate() const;

private:
    static constexpr int kWidth = 8;
    static constexpr uint32_t kNowhere = ~0u;
    static constexpr uint32_t kNoNode = ~0u;
    static constexpr uint32_t kRoot = 0;
    static constexpr int kPendingSlot = kWidth - 1;  // of the root: the tree of recent insertions
    static constexpr int kMaxDepth = 24;             // of nodes; halving 2^32 leaves by eights needs 12
    static constexpr uint32_t kMaxPendingHeight = 22;
    static constexpr int kMaxStack = (kWidth - 1) * kMaxDepth + 1;

    // Eight boxes, one per column. Upper coordinates are negated, so that the union is a minimum in all rows and a
    // query is "row <= limit" in all rows. Empty slots are in neither mask; their box is inverted.
    struct alignas(64) Node {
        float lower[3][kWidth];
        uint32_t child[kWidth];  // a node, or the id of a leaf
        float negatedUpper[3][kWidth];
        uint32_t parent;  // kNoNode for the root; the next free node for a free one
        uint8_t parentSlot;
        uint8_t leaves;           // slots that hold leaves
        uint8_t inner;            // slots that hold nodes
        uint8_t stale;            // inner slots whose box may be larger than needed
        uint8_t appended;         // pending nodes: slots used so far
        uint8_t depthFromLeaves;  // pending nodes: 0 holds leaves
    };
    static_assert(sizeof(Node) == 256);

    // A box as {lower, w, -upper, w'}: the union of boxes is the lane-wise minimum. w and w' are free for other data.
    struct alignas(32) Packed {
        float lane[8];
    };

    static Packed Pack(const Bounds& bounds);
    static Bounds Unpack(const Packed& box);
    static Packed EmptyBox();
    static Packed Union(const Node& node);
    static void LimitOf(const Packed& box, float (&limit)[6]);
    static double HalfArea(const Packed& box);
    static bool IsValid(const Bounds& bounds);

    Packed SlotBox(uint32_t node, int slot) const;
    void SetSlotBox(uint32_t node, int slot, const Packed& box);
    // A slot alone, without the mask of its node: other slots may be filled at the same time.
    void FillWithLeaf(uint32_t node, int slot, uint32_t id, const Packed& box);
    void FillWithNode(uint32_t node, int slot, uint32_t child, const Packed& box);
    void SetLeaf(uint32_t node, int slot, uint32_t id, const Packed& box);
    void Link(uint32_t node, int slot, uint32_t child, const Packed& box);
    void SetInner(uint32_t node, int slot, uint32_t child, const Packed& box);
    bool Enlarge(uint32_t node, int slot, const Packed& box);
    void Loosen(uint32_t node, const Packed& box);
    Packed Refit(uint32_t node);

    uint32_t AllocateNode();
    void ResetNode(uint32_t node);
    void ReleaseIfEmpty(uint32_t node);
    uint32_t PendingLeafNode();
    void AppendToSpine(uint32_t height);

    double AreaIfBuilt() const;
    void GatherLeaves();
    uint32_t MoveLargeLeavesToBack();
    // Gathered leaves that fill slots of a node, in children of a capacity, whose nodes are numbered from nextNode.
    struct Part {
        uint32_t node;
        int slot;  // the first
        uint32_t first, count;
        uint32_t capacity;  // leaves: a power of eight, or 1
        uint32_t nextNode;
        double area = 0;                                // of the nodes made
        bool IsSmall() const { return count <= 2048; }  // built by one thread, in a tenth of a millisecond
        bool IsNode() const { return count <= capacity; }
        uint32_t CountOfLeft() const;
        Part Left() const;
        Part Right() const;
    };
    void PlanParts();
    void BuildParts(size_t whole, const ParallelLoop& parallel);
    void MarkSlots(const Part& part);
    Packed BuildPart(const Part& part, double& area);
    void SplitAt(uint32_t first, uint32_t count, uint32_t left);

    void ValidateNode(uint32_t node, int depth, uint32_t& nodes, uint32_t& leaves) const;

    static uint32_t TestSlots(const Node& node, const float (&limit)[6]);
    static uint32_t CastToSlots(const Node& node, const TreeRay& ray, float maxFraction, float (&nearest)[kWidth]);
    static uint32_t MeasureSlots(const Node& node, const float (&limit)[6], float maxSquare, float (&square)[kWidth]);
    // Visits nodes in the order of the values that `test` gives their slots, up to the value that `limit` gives.
    template <class Test, class Limit, class Visitor>
    void VisitInOrder(Test&& test, Limit&& limit, Visitor&& visit) const;

    Array<Node> nodes_;                              // the first nodeCount_ are in use or on the free list
    Array<uint32_t> places_;                         // id -> node * kWidth + slot
    Array<Packed> gathered_;                         // Rebuild's leaves; lane 3 holds the id's bits
    Array<Part> parts_;                              // Rebuild's parts
    uint32_t pendingSpine_[kMaxPendingHeight] = {};  // the pending tree's node being filled, by height
    uint32_t pendingHeight_ = 0;                     // nodes on the spine
    uint32_t nodeCount_ = 0;
    uint32_t freeNode_ = kNoNode;
    uint32_t size_ = 0;
    uint32_t pendingCount_ = 0;  // insertions since the last build
    uint32_t changesSinceOptimize_ = 0;
    double area_ = 0;                 // sum of the half surface areas of all nodes but the root
    double builtArea_ = 0;            // the same after the last build
    double insertedExtents_[3] = {};  // sums over the insertions since then, m
    double debt_ = 0;                 // extra work of queries since the last build, in queries
};

// The slots whose boxes overlap the query; limit = {upper, -lower}.
inline uint32_t BoundsTree::TestSlots(const Node& node, const float (&limit)[6]) {
    constexpr int kStep = kLanes >= 8 ? 8 : 4;
    using Lanes = Wide<kStep>;
    uint32_t bits = 0;
    for (int i = 0; i < kWidth; i += kStep) {
        const auto below = (Lanes::Load(node.lower[0] + i) <= Lanes(limit[0])) &
                           (Lanes::Load(node.lower[1] + i) <= Lanes(limit[1])) &
                           (Lanes::Load(node.lower[2] + i) <= Lanes(limit[2]));
        const auto above = (Lanes::Load(node.negatedUpper[0] + i) <= Lanes(limit[3])) &
                           (Lanes::Load(node.negatedUpper[1] + i) <= Lanes(limit[4])) &
                           (Lanes::Load(node.negatedUpper[2] + i) <= Lanes(limit[5]));
        bits |= (below & above).ToBits() << i;
    }
    return bits;
}

template <class Visitor>
void BoundsTree::Query(const Bounds& bounds, Visitor&& visit) const {
    if (size_ == 0) return;
    const float limit[6] = {bounds.upper.x(),  bounds.upper.y(),  bounds.upper.z(),
                            -bounds.lower.x(), -bounds.lower.y(), -bounds.lower.z()};
    uint32_t stack[kMaxStack];
    int top = 0;
    stack[top++] = kRoot;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        const uint32_t hits = TestSlots(node, limit);
        for (uint32_t leaves = hits & node.leaves; leaves != 0; leaves &= leaves - 1)
            visit(node.child[std::countr_zero(leaves)]);
        for (uint32_t inner = hits & node.inner; inner != 0; inner &= inner - 1)
            stack[top++] = node.child[std::countr_zero(inner)];
    }
}

// All boxes of leaves are clamped here. Min returns its second operand for NaN.
inline BoundsTree::Packed BoundsTree::Pack(const Bounds& b) {
    Packed box = {{b.lower.x(), b.lower.y(), b.lower.z(), 0, -b.upper.x(), -b.upper.y(), -b.upper.z(), 0}};
    Max(Min(Wide<8>::Load(box.lane), Wide<8>(kFarthest)), Wide<8>(-kFarthest)).Store(box.lane);
    return box;
}

inline Bounds BoundsTree::Unpack(const Packed& box) {
    Bounds bounds;
    bounds.lower = Vector3(box.lane[0], box.lane[1], box.lane[2]);
    bounds.upper = Vector3(-box.lane[4], -box.lane[5], -box.lane[6]);
    return bounds;
}

// The box around a node's eight slots; empty ones are inverted and do not count.
inline BoundsTree::Packed BoundsTree::Union(const Node& node) {
    // The fourth rows hold arbitrary values: their lanes are not read.
    const float* const rows[8] = {node.lower[0],        node.lower[1],        node.lower[2],
                                  node.lower[2],        node.negatedUpper[0], node.negatedUpper[1],
                                  node.negatedUpper[2], node.negatedUpper[2]};
    Wide<8> column[8];
    GatherRows<8>(rows, column);
    Packed box;
    Min(Min(Min(column[0], column[1]), Min(column[2], column[3])),
        Min(Min(column[4], column[5]), Min(column[6], column[7])))
        .Store(box.lane);
    return box;
}

inline BoundsTree::Packed BoundsTree::SlotBox(uint32_t node, int slot) const {
    const Node& n = nodes_[node];
    return {{n.lower[0][slot], n.lower[1][slot], n.lower[2][slot], 0, n.negatedUpper[0][slot], n.negatedUpper[1][slot],
             n.negatedUpper[2][slot], 0}};
}

inline void BoundsTree::SetSlotBox(uint32_t node, int slot, const Packed& box) {
    Node& n = nodes_[node];
    for (int axis = 0; axis < 3; ++axis) {
        n.lower[axis][slot] = box.lane[axis];
        n.negatedUpper[axis][slot] = box.lane[4 + axis];
    }
}

}  // namespace fulcrum
