// The bulk build of a BoundsTree: top down, splitting at medians along the longest axis of the centers, at multiples of
// a power of eight, so that all nodes but the last of each height are full.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace fulcrum {

namespace {

constexpr int kIdLane = 3;
constexpr int kBins = 128;
constexpr uint32_t kSmallSplit = 64;

// Twice a leaf's center.
inline float Center(const float* leaf, int axis) { return leaf[axis] - leaf[4 + axis]; }

struct Spread {
    int axis;
    float lowest, extent;
    // False if all centers coincide or overflow: any split is then as good as another.
    bool IsUsable() const { return extent > 1e-30f && extent < std::numeric_limits<float>::max(); }
};

// The axis along which the centers lie farthest apart.
template <class Leaf>
Spread LongestSpread(const Leaf* leaves, uint32_t count) {
    // The fourth lane holds an id's bits. It is not multiplied: denormal numbers are slow.
    using Lanes = Wide<4>;
    constexpr uint32_t kChains = 4;  // independent dependency chains
    const auto center = [&](uint32_t i) { return Lanes::Load(leaves[i].lane) - Lanes::Load(leaves[i].lane + 4); };
    Lanes lowest = center(0), highest = lowest;
    uint32_t i = 1;
    if (count >= kChains) {
        Lanes low[kChains], high[kChains];
        for (uint32_t k = 0; k < kChains; ++k) low[k] = high[k] = center(k);
        for (i = kChains; i + kChains <= count; i += kChains) {
            for (uint32_t k = 0; k < kChains; ++k) {
                const Lanes c = center(i + k);
                low[k] = Min(low[k], c);
                high[k] = Max(high[k], c);
            }
        }
        lowest = Min(Min(low[0], low[1]), Min(low[2], low[3]));
        highest = Max(Max(high[0], high[1]), Max(high[2], high[3]));
    }
    for (; i < count; ++i) {
        lowest = Min(lowest, center(i));
        highest = Max(highest, center(i));
    }
    const Lanes extent = highest - lowest;
    int axis = extent[1] > extent[0] ? 1 : 0;
    if (extent[2] > extent[axis]) axis = 2;
    return {axis, lowest[axis], extent[axis]};
}

template <class Leaf>
inline void Swap(Leaf& a, Leaf& b) {
    const Wide<8> was = Wide<8>::Load(a.lane);
    Wide<8>::Load(b.lane).Store(a.lane);
    was.Store(b.lane);
}

// Moves the elements for which `belongs` is true to the front. Without branches, which would be mispredicted half the
// time.
template <class Leaf, class Test>
void Partition(Leaf* leaves, uint32_t count, Test belongs) {
    uint32_t end = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const bool isFront = belongs(leaves[i]);
        Swap(leaves[i], leaves[end]);
        end += isFront;
    }
}

// The split of a small range: a leaf's rank is the number of leaves with smaller keys, counted in lanes.
template <class Leaf>
void SplitByRank(Leaf* leaves, uint32_t count, uint32_t left, const Spread& spread) {
    constexpr int kStep = kLanes >= 8 ? 8 : 4;
    using Lanes = Wide<kStep>;
    // Keys in [1, 2], of which the last bits are the leaf's index: no two are equal.
    alignas(32) float keys[kSmallSplit];
    const float scale = 1.0f / spread.extent;
    for (uint32_t i = 0; i < count; ++i) {
        const float key = 1.0f + (Center(leaves[i].lane, spread.axis) - spread.lowest) * scale;
        keys[i] = std::bit_cast<float>((std::bit_cast<uint32_t>(key) & ~(kSmallSplit - 1)) | i);
    }
    for (uint32_t i = count; i % kStep != 0; ++i) keys[i] = std::numeric_limits<float>::infinity();
    uint32_t end = 0;
    for (uint32_t i = 0; i < count; ++i) {
        int rank = 0;
        for (uint32_t j = 0; j < count; j += kStep)
            rank += std::popcount((Lanes::Load(keys + j) < Lanes(keys[i])).ToBits());
        Swap(leaves[i], leaves[end]);
        end += static_cast<uint32_t>(rank) < left;
    }
}

}  // namespace

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

namespace {

// Nodes that hold leaves are full but for the last one of each height: how many nodes there are follows from the number
// of leaves alone, so that parts of the tree are built at the same time, each in nodes of its own.

// The least number of leaves of a child, a power of eight, with which so many slots hold them all.
uint32_t CapacityFor(uint32_t count, uint32_t slots) {
    uint64_t capacity = 8;
    while (capacity * slots < count) capacity *= 8;
    return static_cast<uint32_t>(capacity);
}

uint32_t NodesOf(uint32_t count, uint32_t capacity);
// Below a node of eight slots.
uint32_t NodesBelow(uint32_t count) { return count <= 8 ? 0 : NodesOf(count, CapacityFor(count, 8)); }
// Children of the given capacity, a single leaf being none, with all below them.
uint32_t NodesOf(uint32_t count, uint32_t capacity) {
    const uint32_t full = count / capacity, rest = count % capacity;
    return (capacity > 1 ? full * (1 + NodesBelow(capacity)) : 0) + (rest > 1 ? 1 + NodesBelow(rest) : 0);
}

}  // namespace

void BoundsTree::Rebuild(const ParallelLoop& parallel) {
    if (size_ == 0) return;
    GatherLeaves();
    const uint32_t large = MoveLargeLeavesToBack(), small = size_ - large;
    // One or two large leaves lie in the root itself, more of them in a child of it.
    const uint32_t ofLarge = large <= 2 ? 1 : large, slots = kPendingSlot - (large <= 2 ? large : 1);
    const uint32_t ofSmall = small <= slots ? 1 : CapacityFor(small, slots);
    const uint32_t first = 1 + NodesOf(large, ofLarge);
    const uint32_t nodes = first + NodesOf(small, ofSmall);
    if (nodes > nodes_.size()) nodes_.resize(nodes);
    parts_.clear();
    if (large > 0) parts_.push_back({kRoot, 0, small, large, ofLarge, 1});
    parts_.push_back({kRoot, kPendingSlot - static_cast<int>(slots), 0, small, ofSmall, first});
    const size_t whole = parts_.size();
    PlanParts();
    // All that may fail is done.
    nodeCount_ = nodes;
    freeNode_ = kNoNode;
    pendingHeight_ = pendingCount_ = changesSinceOptimize_ = 0;
    debt_ = 0;
    std::fill_n(insertedExtents_, 3, 0.0);
    ResetNode(kRoot);
    BuildParts(whole, parallel);
    builtArea_ = area_;
}

// Lists the halves into which large parts are split, and the parts below nodes with many leaves, behind those that they
// replace.
void BoundsTree::PlanParts() {
    for (size_t i = 0; i < parts_.size(); ++i) {
        const Part part = parts_[i];
        if (part.IsSmall()) continue;
        if (part.IsNode()) {
            parts_.push_back(
                {part.nextNode, 0, part.first, part.count, CapacityFor(part.count, kWidth), part.nextNode + 1});
        } else {
            parts_.push_back(part.Left());
            parts_.push_back(part.Right());
        }
    }
}

// Splits the large parts, one round of halves after the other, and builds the small ones, at the same time. The result
// does not depend on the threads. whole: how many parts were not planned.
void BoundsTree::BuildParts(size_t whole, const ParallelLoop& parallel) {
    for (size_t begin = 0, end = whole; begin < end;) {
        RunLoop(parallel, static_cast<uint32_t>(end - begin), [this, begin](uint32_t i) {
            const Part& part = parts_[begin + i];
            if (!part.IsSmall() && !part.IsNode()) SplitAt(part.first, part.count, part.CountOfLeft());
        });
        size_t next = end;
        for (; begin < end; ++begin) {
            const Part& part = parts_[begin];
            if (part.IsSmall()) continue;
            next += part.IsNode() ? 1 : 2;
            if (!part.IsNode()) continue;
            ResetNode(part.nextNode);
            Link(part.node, part.slot, part.nextNode, EmptyBox());
        }
        end = next;
    }
    for (const Part& part : parts_)
        if (part.IsSmall()) MarkSlots(part);
    RunLoop(parallel, static_cast<uint32_t>(parts_.size()), [this](uint32_t i) {
        Part& part = parts_[i];
        if (part.IsSmall()) BuildPart(part, part.area);
    });
    area_ = 0;
    for (size_t i = parts_.size(); i-- > 0;) {  // children before parents
        const Part& part = parts_[i];
        area_ += part.area;
        if (part.IsSmall() || !part.IsNode()) continue;
        const Packed box = Union(nodes_[part.nextNode]);
        SetSlotBox(part.node, part.slot, box);
        area_ += HalfArea(box);
    }
}

// The left half of the children, all full, and the rest.
uint32_t BoundsTree::Part::CountOfLeft() const { return ((count - 1) / capacity + 1) / 2 * capacity; }
BoundsTree::Part BoundsTree::Part::Left() const {
    Part left = *this;
    left.count = CountOfLeft();
    return left;
}
BoundsTree::Part BoundsTree::Part::Right() const {
    Part right = *this;
    const uint32_t left = CountOfLeft();
    right.slot += static_cast<int>(left / capacity);
    right.first += left;
    right.count -= left;
    right.nextNode += NodesOf(left, capacity);
    return right;
}

// Sets which slots of a part will hold leaves, and which nodes: those of a node are in one byte, and several parts may
// fill its slots at the same time.
void BoundsTree::MarkSlots(const Part& part) {
    Node& n = nodes_[part.node];
    int slot = part.slot;
    for (uint32_t left = part.count; left > 0; ++slot) {
        const uint32_t count = std::min(left, part.capacity);
        (count == 1 ? n.leaves : n.inner) |= static_cast<uint8_t>(1u << slot);
        left -= count;
    }
}

// Fills the slots of a part, which are marked. Adds up the areas of the new nodes, and returns the box around them.
BoundsTree::Packed BoundsTree::BuildPart(const Part& part, double& area) {
    if (part.count > part.capacity) {
        SplitAt(part.first, part.count, part.CountOfLeft());
        const Packed left = BuildPart(part.Left(), area), right = BuildPart(part.Right(), area);
        Packed both;
        Min(Wide<8>::Load(left.lane), Wide<8>::Load(right.lane)).Store(both.lane);
        return both;
    }
    Packed box = gathered_[part.first];
    if (part.count == 1) {
        FillWithLeaf(part.node, part.slot, std::bit_cast<uint32_t>(box.lane[kIdLane]), box);
        return box;
    }
    const uint32_t node = part.nextNode;
    ResetNode(node);
    if (part.count > kWidth) {
        const Part below{node, 0, part.first, part.count, CapacityFor(part.count, kWidth), node + 1};
        MarkSlots(below);
        box = BuildPart(below, area);
    } else {
        Wide<8> total(std::numeric_limits<float>::infinity());
        for (uint32_t i = 0; i < part.count; ++i) {
            const Packed& leaf = gathered_[part.first + i];
            SetLeaf(node, static_cast<int>(i), std::bit_cast<uint32_t>(leaf.lane[kIdLane]), leaf);
            total = Min(total, Wide<8>::Load(leaf.lane));
        }
        total.Store(box.lane);
    }
    FillWithNode(part.node, part.slot, node, box);
    area += HalfArea(box);
    return box;
}

// Floors and walls among small boxes would enlarge every node above them. Moves the few leaves that are longer than a
// quarter of the whole to the back, and returns their number.
uint32_t BoundsTree::MoveLargeLeavesToBack() {
    using Lanes = Wide<4>;
    Wide<8> total(std::numeric_limits<float>::infinity());
    for (const Packed& leaf : gathered_) total = Min(total, Wide<8>::Load(leaf.lane));
    float longest = 0;
    for (int axis = 0; axis < 3; ++axis) longest = Max(longest, -total[4 + axis] - total[axis]);
    const Lanes limit(-0.25f * longest);
    const auto isSmall = [&](const Packed& leaf) {
        const Lanes negatedExtent = Lanes::Load(leaf.lane) + Lanes::Load(leaf.lane + 4);
        return ((negatedExtent < limit).ToBits() & 7u) == 0;  // the fourth lane is the id's
    };
    uint32_t large = 0;
    for (const Packed& leaf : gathered_) large += !isSmall(leaf);
    if (large == 0 || large > size_ / kWidth) return 0;
    Partition(gathered_.data(), size_, isSmall);
    return large;
}

// Reorders a range so that its first `left` leaves have the smaller centers, along the axis on which the centers lie
// farthest apart. Leaves with the same center may go to either side.
void BoundsTree::SplitAt(uint32_t first, uint32_t count, uint32_t left) {
    while (left > 0 && left < count) {
        const Spread spread = LongestSpread(&gathered_[first], count);
        if (!spread.IsUsable()) return;
        if (count <= kSmallSplit) {
            SplitByRank(&gathered_[first], count, left, spread);
            return;
        }
        // A histogram gives the slab that holds the median; the search goes on inside it.
        const float scale = static_cast<float>(kBins) / spread.extent;
        const auto place = [&](const Packed& leaf) { return (Center(leaf.lane, spread.axis) - spread.lowest) * scale; };
        uint32_t histogram[kBins] = {};
        for (uint32_t i = first; i < first + count; ++i)
            ++histogram[std::min(static_cast<int>(place(gathered_[i])), kBins - 1)];
        int bin = 0;
        uint32_t below = 0;
        while (below + histogram[bin] <= left) below += histogram[bin++];
        const float slabBegin = static_cast<float>(bin), slabEnd = bin + 1 < kBins ? slabBegin + 1 : 2 * kBins;
        Partition(&gathered_[first], count, [&](const Packed& leaf) { return place(leaf) < slabBegin; });
        if (below == left) return;
        Partition(&gathered_[first + below], count - below, [&](const Packed& leaf) { return place(leaf) < slabEnd; });
        first += below;
        count = histogram[bin];
        left -= below;
    }
}

}  // namespace fulcrum
