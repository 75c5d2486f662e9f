#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <Fulcrum/Math/Assert.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uint8_t kBuilt = 255;  // depthFromLeaves of nodes that Rebuild made

// The cost of a rebuild per leaf, in queries: a ratio that does not depend on the machine.
constexpr double kBuildCostInQueries = 0.3;

// The extra cost of a query of leaves in the order of their insertion, in queries of the built tree, where neighbors
// are inserted one after the other: ten thousand overlaps take 2.05 times the instructions. In a random order far more.
constexpr double kLeastPendingExcess = 1;
}  // namespace

// ---- Boxes

BoundsTree::Packed BoundsTree::EmptyBox() {
    return {{kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity, kInfinity}};
}

// In double: the square of any float is finite there.
double BoundsTree::HalfArea(const Packed& box) {
    if (box.lane[0] == kInfinity) return 0;
    const double x = -double(box.lane[4]) - double(box.lane[0]);
    const double y = -double(box.lane[5]) - double(box.lane[1]);
    const double z = -double(box.lane[6]) - double(box.lane[2]);
    return x * y + y * z + z * x;
}

bool BoundsTree::IsValid(const Bounds& b) { return b.lower.isAtMost(b.upper); }

// ---- Nodes

uint32_t BoundsTree::AllocateNode() {
    uint32_t index = freeNode_;
    if (index != kNoNode) {
        freeNode_ = nodes_[index].parent;
    } else {
        index = nodeCount_;
        if (index == nodes_.size()) {
            // Grows by an eighth instead of doubling: the nodes are most of the memory.
            if (nodes_.size() == nodes_.capacity()) nodes_.reserve(nodes_.size() + nodes_.size() / 8 + 16);
            nodes_.emplace_back();
        }
        ++nodeCount_;
    }
    ResetNode(index);
    return index;
}

void BoundsTree::ResetNode(uint32_t index) {
    Node& n = nodes_[index];
    std::fill_n(&n.lower[0][0], 3 * kWidth, kInfinity);
    std::fill_n(&n.negatedUpper[0][0], 3 * kWidth, kInfinity);
    std::fill_n(n.child, kWidth, kNoNode);
    n.parent = kNoNode;
    n.parentSlot = 0;
    n.leaves = n.inner = n.stale = n.appended = 0;
    n.depthFromLeaves = kBuilt;
}

void BoundsTree::FillWithLeaf(uint32_t node, int slot, uint32_t id, const Packed& box) {
    SetSlotBox(node, slot, box);
    nodes_[node].child[slot] = id;
    places_[id] = node * kWidth + static_cast<uint32_t>(slot);
}

void BoundsTree::SetLeaf(uint32_t node, int slot, uint32_t id, const Packed& box) {
    FillWithLeaf(node, slot, id, box);
    nodes_[node].leaves |= static_cast<uint8_t>(1u << slot);
}

void BoundsTree::FillWithNode(uint32_t node, int slot, uint32_t child, const Packed& box) {
    SetSlotBox(node, slot, box);
    nodes_[node].child[slot] = child;
    nodes_[child].parent = node;
    nodes_[child].parentSlot = static_cast<uint8_t>(slot);
}

void BoundsTree::Link(uint32_t node, int slot, uint32_t child, const Packed& box) {
    FillWithNode(node, slot, child, box);
    nodes_[node].inner |= static_cast<uint8_t>(1u << slot);
}

void BoundsTree::SetInner(uint32_t node, int slot, uint32_t child, const Packed& box) {
    Link(node, slot, child, box);
    area_ += HalfArea(box);
}

void BoundsTree::ReleaseIfEmpty(uint32_t node) {
    while (node != kRoot) {
        Node& n = nodes_[node];
        const bool isBeingFilled = n.depthFromLeaves < pendingHeight_ && pendingSpine_[n.depthFromLeaves] == node;
        if ((n.leaves | n.inner) != 0 || isBeingFilled) return;
        const uint32_t parent = n.parent;
        const int slot = n.parentSlot;
        area_ -= HalfArea(SlotBox(parent, slot));
        SetSlotBox(parent, slot, EmptyBox());
        nodes_[parent].inner &= static_cast<uint8_t>(~(1u << slot));
        nodes_[parent].stale &= static_cast<uint8_t>(~(1u << slot));
        n.parent = freeNode_;
        freeNode_ = node;
        node = parent;
    }
}

// ---- Leaves

void BoundsTree::Insert(uint32_t id, const Bounds& bounds) {
    FULCRUM_ASSERT(!Contains(id) && IsValid(bounds));
    if (id >= places_.size()) places_.resize(id + 1, kNowhere);
    if (nodeCount_ == 0) AllocateNode();
    const uint32_t node = PendingLeafNode();
    const Packed box = Pack(bounds);
    SetLeaf(node, nodes_[node].appended++, id, box);
    // Boxes that were tight are tight again. Where one contains the new box, so do those above.
    for (uint32_t n = node; n != kRoot; n = nodes_[n].parent)
        if (!Enlarge(nodes_[n].parent, nodes_[n].parentSlot, box)) break;
    ++size_;
    ++pendingCount_;
    for (int axis = 0; axis < 3; ++axis) insertedExtents_[axis] -= double{box.lane[axis]} + double{box.lane[4 + axis]};
    ++changesSinceOptimize_;
}

// The node of recent arrivals that has a slot to append to.
uint32_t BoundsTree::PendingLeafNode() {
    if (pendingHeight_ == 0) {
        const uint32_t node = AllocateNode();
        nodes_[node].depthFromLeaves = 0;
        SetInner(kRoot, kPendingSlot, node, EmptyBox());
        pendingSpine_[pendingHeight_++] = node;
    } else if (nodes_[pendingSpine_[0]].appended == kWidth) {
        AppendToSpine(0);
    }
    return pendingSpine_[0];
}

// Replaces the full spine node of a height by a new one beside it, as a counter in base eight carries.
void BoundsTree::AppendToSpine(uint32_t height) {
    const uint32_t full = pendingSpine_[height];
    const uint32_t node = AllocateNode();
    nodes_[node].depthFromLeaves = static_cast<uint8_t>(height);
    if (height + 1 == pendingHeight_) {
        // The pending tree grows by a root above its old one.
        FULCRUM_ASSERT(pendingHeight_ < kMaxPendingHeight);
        const uint32_t above = AllocateNode();
        const Packed box = SlotBox(kRoot, kPendingSlot);
        const uint8_t isStale = nodes_[kRoot].stale >> kPendingSlot;
        area_ -= HalfArea(box);
        SetInner(above, 0, full, box);
        SetInner(kRoot, kPendingSlot, above, box);
        nodes_[above].depthFromLeaves = static_cast<uint8_t>(pendingHeight_);
        nodes_[above].stale = isStale;
        nodes_[above].appended = 1;
        pendingSpine_[pendingHeight_++] = above;
    } else if (nodes_[pendingSpine_[height + 1]].appended == kWidth) {
        AppendToSpine(height + 1);
    }
    const uint32_t parent = pendingSpine_[height + 1];
    SetInner(parent, nodes_[parent].appended++, node, EmptyBox());
    pendingSpine_[height] = node;
    ReleaseIfEmpty(full);
}

void BoundsTree::Remove(uint32_t id) {
    FULCRUM_ASSERT(Contains(id));
    const uint32_t node = places_[id] / kWidth;
    const int slot = static_cast<int>(places_[id] % kWidth);
    places_[id] = kNowhere;
    if (--size_ == 0) {
        Clear();
        return;
    }
    SetSlotBox(node, slot, EmptyBox());
    nodes_[node].leaves &= static_cast<uint8_t>(~(1u << slot));
    Loosen(node, EmptyBox());
    ReleaseIfEmpty(node);
}

void BoundsTree::Update(uint32_t id, const Bounds& bounds) {
    FULCRUM_ASSERT(Contains(id) && IsValid(bounds));
    const uint32_t node = places_[id] / kWidth;
    const Packed box = Pack(bounds);
    SetSlotBox(node, static_cast<int>(places_[id] % kWidth), box);
    Loosen(node, box);
    ++changesSinceOptimize_;
}

Bounds BoundsTree::GetBounds(uint32_t id) const {
    FULCRUM_ASSERT(Contains(id));
    return Unpack(SlotBox(places_[id] / kWidth, static_cast<int>(places_[id] % kWidth)));
}

// Enlarges a slot's box; false if it contains the other one already.
bool BoundsTree::Enlarge(uint32_t node, int slot, const Packed& box) {
    Node& n = nodes_[node];
    bool contains = true;
    for (int axis = 0; axis < 3; ++axis)
        contains &= (n.lower[axis][slot] <= box.lane[axis]) & (n.negatedUpper[axis][slot] <= box.lane[4 + axis]);
    if (contains) return false;
    area_ -= HalfArea(SlotBox(node, slot));
    for (int axis = 0; axis < 3; ++axis) {
        n.lower[axis][slot] = Min(n.lower[axis][slot], box.lane[axis]);
        n.negatedUpper[axis][slot] = Min(n.negatedUpper[axis][slot], box.lane[4 + axis]);
    }
    area_ += HalfArea(SlotBox(node, slot));
    return true;
}

// A box inside `node` changed to `box`: enlarges the ancestors' slots that do not contain it and marks all of them
// stale (possibly too large). If a slot contains the box, so do those above; if a slot is stale, so are those above.
void BoundsTree::Loosen(uint32_t node, const Packed& box) {
    while (node != kRoot) {
        const int slot = nodes_[node].parentSlot;
        node = nodes_[node].parent;
        Node& n = nodes_[node];
        const uint8_t bit = static_cast<uint8_t>(1u << slot);
        const bool wasStale = (n.stale & bit) != 0;
        n.stale |= bit;
        if (!Enlarge(node, slot, box) && wasStale) return;
    }
}

// ---- Upkeep

// Refits the stale slots below a node. Returns the node's box.
BoundsTree::Packed BoundsTree::Refit(uint32_t node) {
    for (uint32_t stale = nodes_[node].stale; stale != 0; stale &= stale - 1) {
        const int slot = std::countr_zero(stale);
        const Packed box = Refit(nodes_[node].child[slot]);
        area_ += HalfArea(box) - HalfArea(SlotBox(node, slot));
        SetSlotBox(node, slot, box);
    }
    nodes_[node].stale = 0;
    return Union(nodes_[node]);
}

void BoundsTree::NoteUpdated(uint32_t changed) {
    for (uint32_t node = 0; node < nodeCount_; ++node) nodes_[node].stale = nodes_[node].inner;
    changesSinceOptimize_ += changed;
}

// An estimate of the area that a rebuild would reach: of full nodes that share a box around all leaves, halved along
// its longest axis until there are enough, each as much larger as the leaves are on average.
double BoundsTree::AreaIfBuilt() const {
    const Bounds all = TotalBounds();
    double cell[3], leaf[3];
    for (int axis = 0; axis < 3; ++axis) {
        leaf[axis] = insertedExtents_[axis] / pendingCount_;
        cell[axis] = std::max(double{all.upper[axis]} - double{all.lower[axis]} - leaf[axis], 0.0);
    }
    double sum = 0;
    for (double nodes = 1; nodes * kWidth < size_;) {
        for (int half = 1; half < kWidth; half *= 2) *std::max_element(cell, cell + 3) *= 0.5;
        nodes *= kWidth;
        const double x = cell[0] + leaf[0], y = cell[1] + leaf[1], z = cell[2] + leaf[2];
        sum += std::min(nodes, static_cast<double>(size_) / kWidth) * (x * y + y * z + z * x);
    }
    return sum;
}

void BoundsTree::Optimize(uint32_t queries, const ParallelLoop& parallel) {
    if (size_ == 0) return;
    if (nodes_[kRoot].stale != 0) Refit(kRoot);
    const double built = IsMostlyPending() ? AreaIfBuilt() : builtArea_;
    double excess = built > 0 ? std::max(0.0, area_ / built - 1) : 0;
    // Beside a plane, whose area nothing compares with, the estimate says nothing.
    if (IsMostlyPending()) excess = std::max(excess, kLeastPendingExcess);
    debt_ += excess * queries;
    changesSinceOptimize_ = 0;
    if (debt_ > kBuildCostInQueries * size_) Rebuild(parallel);
}

void BoundsTree::Clear() {
    std::fill(places_.begin(), places_.end(), kNowhere);
    nodeCount_ = size_ = pendingCount_ = pendingHeight_ = changesSinceOptimize_ = 0;
    freeNode_ = kNoNode;
    area_ = builtArea_ = debt_ = 0;
    std::fill_n(insertedExtents_, 3, 0.0);
}

void BoundsTree::Reserve(size_t ids) {
    if (ids > places_.size()) places_.resize(ids, kNowhere);
    gathered_.reserve(ids);
    // Each part of more than 2048 leaves adds two at most. Their sizes halve, and every third is a node's: fewer than
    // 2 + 2 * (1 + 1/2 + ...) * 3/2 ids / 2048 parts, twice as many where halves are not equal.
    parts_.reserve(2 + ids / 128);
    // Nodes of eight, the nodes above them, and those on the ways to nodes that are not full.
    nodes_.reserve(ids / kWidth + ids / (kWidth * (kWidth - 2)) + 2 * kMaxDepth);
}

void BoundsTree::ReserveInsertions(uint32_t count, size_t ids) {
    if (count == 0) return;
    if (ids > places_.capacity()) places_.reserve(std::max(ids, 2 * places_.capacity()));
    // Of each height count / 8, count / 64, ... nodes, and one more that is begun; the root. 2^32 leaves add 11
    // heights.
    constexpr size_t kMoreHeights = 11;
    const size_t nodes = nodeCount_ + count / (kWidth - 1) + pendingHeight_ + kMoreHeights + 1;
    if (nodes > nodes_.capacity()) nodes_.reserve(std::max(nodes, nodes_.capacity() + nodes_.capacity() / 8 + 16));
}

Bounds BoundsTree::TotalBounds() const { return size_ == 0 ? Bounds{} : Unpack(Union(nodes_[kRoot])); }

float BoundsTree::Cost() const {
    if (size_ == 0) return 0;
    double sum = 0;
    uint32_t nodes = 1;
    uint32_t stack[kMaxStack];
    int top = 0;
    stack[top++] = kRoot;
    while (top > 0) {
        const uint32_t node = stack[--top];
        for (uint32_t inner = nodes_[node].inner; inner != 0; inner &= inner - 1) {
            const int slot = std::countr_zero(inner);
            sum += HalfArea(SlotBox(node, slot));
            ++nodes;
            stack[top++] = nodes_[node].child[slot];
        }
    }
    const double total = HalfArea(Union(nodes_[kRoot]));
    // If the total has no area, every line through it goes through every node.
    return static_cast<float>(total > 0 ? 1 + sum / total : nodes);
}

size_t BoundsTree::MemoryUsed() const {
    return nodes_.capacity() * sizeof(Node) + places_.capacity() * sizeof(uint32_t) +
           gathered_.capacity() * sizeof(Packed) + parts_.capacity() * sizeof(Part);
}

}  // namespace fulcrum
