// The tree of a triangle mesh, and its traversal. Used by TriangleMesh alone; read-only once built, so thread-safe.
//
// Eight-way nodes of 80 bytes. The boxes of the children are given in 1/255ths of the node's own box, rounded outwards.
// A child is a node or a leaf of up to eight triangles. Nodes come before their children, and the triangles of a node's
// leaves are consecutive, so that a child takes one byte in addition to its box. Vertices are numbered in the order in
// which the triangles use them first. So the vertices of 64 consecutive triangles mostly have numbers within 65,536 of
// each other, and an index takes two bytes; otherwise four.
#pragma once

#include <Fulcrum/Collision/Shapes/BoxDistance.h>
#include <Fulcrum/Math/Wide.h>

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum {

struct MeshNode {
    static constexpr int kWidth = 8;
    static constexpr int kMaxLeaf = 8;  // triangles

    float origin[3];
    uint8_t exponent[3];       // the grid's step along an axis is 2^(exponent - 127) m
    uint8_t counts;            // children that are nodes, plus 16 times all children
    uint8_t lower[3][kWidth];  // in steps from the origin; children that are nodes first
    uint8_t upper[3][kWidth];
    uint8_t leafEnd[kWidth];  // where the triangles of child i end, from firstTriangle on
    uint32_t firstChild;      // child i that is a node has the number firstChild + i
    uint32_t firstTriangle;

    int NodeCount() const { return counts & 15; }
    int ChildCount() const { return counts >> 4; }
    float Step(int axis) const { return std::bit_cast<float>(static_cast<uint32_t>(exponent[axis]) << 23); }
    float InverseStep(int axis) const {
        return std::bit_cast<float>(static_cast<uint32_t>(254 - exponent[axis]) << 23);
    }
    // The triangles of child i, which is a leaf.
    uint32_t LeafBegin(int i) const { return firstTriangle + (i == NodeCount() ? 0u : leafEnd[i - 1]); }
    uint32_t LeafEnd(int i) const { return firstTriangle + leafEnd[i]; }
};
static_assert(sizeof(MeshNode) == 80);

// Writes the grid and the boxes of a node's children, 1 .. 8, rounded outwards.
void SetBoxes(MeshNode& node, std::span<const Bounds> boxes);

// The search in a node by lanes.
namespace mesh_lanes {
inline constexpr int kStep = kLanes >= 8 ? 8 : 4;
using Lanes = Wide<kStep>;
}  // namespace mesh_lanes

// A ray in the tree's own coordinates, prepared for its nodes. Boxes are enlarged by `pad` m, which is included in the
// origins.
//
// A plane of a box is hit at the fraction byte * (step / direction) + (origin of the grid - origin of the ray) /
// direction. Its rounding, that of the origins here and that of the triangles' own test are at most 2^-22 of the
// coordinates and distances involved. A pad of 2^-20 of them covers it, and a factor of 1 + 2^-18 the rounding of the
// last product. So no leaf of a triangle that the exact test finds is missed.
struct MeshTreeRay {
    Vector3 nearOrigin, farOrigin;    // for the planes where it enters boxes and where it leaves them
    Vector3 nearInverse, farInverse;  // 1 / displacement, bounded

    MeshTreeRay(const Vector3& origin, const Vector3& inverse, float pad)
        : MeshTreeRay(origin, inverse, Vector3(Vector3::Constant(pad))) {}
    MeshTreeRay(const Vector3& origin, const Vector3& inverse, const Vector3& pad)
        : nearInverse(inverse), farInverse(inverse * (1.0f + 0x1p-18f)) {
        for (int axis = 0; axis < 3; ++axis) {
            const float outwards = inverse[axis] >= 0 ? pad[axis] : -pad[axis];
            nearOrigin[axis] = origin[axis] + outwards;
            farOrigin[axis] = origin[axis] - outwards;
        }
    }
};

struct MeshTree {
    static constexpr int kMaxDepth = 32;  // of nodes; the builder keeps below
    static constexpr int kMaxStack = (MeshNode::kWidth - 1) * kMaxDepth + 1;
    static constexpr uint32_t kPageBits = 6;  // 64 triangles share a page of indices
    static constexpr uint32_t kWideIndices = ~0u;

    // Location of the indices of 64 triangles. Narrow ones are relative to firstVertex. kWideIndices: absolute, low
    // half first.
    struct Page {
        uint32_t firstVertex;
        uint32_t offset;  // in `indices`
    };

    std::vector<Vector3> vertices;  // and one more, so that all can be loaded as four floats
    std::vector<MeshNode> nodes;    // the root first
    std::vector<Page> pages;
    std::vector<uint16_t> indices;
    std::vector<uint8_t> materials;  // one byte per triangle; empty: all 0
    std::vector<uint32_t> sources;   // the input's number of each triangle, or empty
    uint32_t triangleCount = 0;

    uint32_t VertexCount() const { return static_cast<uint32_t>(vertices.size()) - 1; }

    void CornersOf(uint32_t triangle, uint32_t (&ids)[3]) const {
        const Page page = pages[triangle >> kPageBits];
        const uint32_t i = triangle & ((1u << kPageBits) - 1);
        if (page.firstVertex != kWideIndices) {
            const uint16_t* at = &indices[page.offset + 3 * i];
            for (int k = 0; k < 3; ++k) ids[k] = page.firstVertex + at[k];
        } else {
            const uint16_t* at = &indices[page.offset + 6 * i];
            for (int k = 0; k < 3; ++k) ids[k] = at[2 * k] | static_cast<uint32_t>(at[2 * k + 1]) << 16;
        }
    }

    size_t MemoryUsed() const {
        return vertices.capacity() * sizeof(Vector3) + nodes.capacity() * sizeof(MeshNode) +
               pages.capacity() * sizeof(Page) + indices.capacity() * sizeof(uint16_t) + materials.capacity() +
               sources.capacity() * sizeof(uint32_t);
    }

    // Calls leaf(begin, end) for every leaf whose box overlaps `box`, which is finite, and perhaps for some close to
    // it.
    template <class Leaf>
    void SearchBox(const Bounds& box, Leaf&& leaf) const;

    // Calls leaf(begin, end) for every leaf whose box is within maxDistance m of `box`, which is finite, the nearest
    // mostly first, and perhaps for some a little farther away. `leaf` may lower maxDistance. An axis of the tree
    // counts `scale` times.
    template <class Leaf>
    void SearchNear(const Bounds& box, const Vector3& scale, const float& maxDistance, Leaf&& leaf) const;

    // Calls leaf(node, child) for the leaves that a ray hits, roughly in order of distance; it returns the largest
    // fraction that is still wanted, negative to stop.
    template <class Leaf>
    void SearchRay(const MeshTreeRay& ray, float maxFraction, Leaf&& leaf) const;
};

// Writes the tree's pages, indices and triangleCount for these corners, three per triangle. At most 2^27 triangles.
void PackIndices(MeshTree& tree, std::span<const uint32_t> corners);

// The children of a node that overlap a box. Compared in the node's own grid; the slack covers the rounding of the
// conversion, 256 * 2^-24 steps.
inline uint32_t OverlappingChildren(const MeshNode& node, const Bounds& box) {
    using mesh_lanes::Lanes, mesh_lanes::kStep;
    constexpr float kSlack = 0x1p-10f;
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float inverse = node.InverseStep(axis);
        low[axis] = (box.lower[axis] - node.origin[axis]) * inverse - kSlack;
        high[axis] = (box.upper[axis] - node.origin[axis]) * inverse + kSlack;
    }
    uint32_t bits = 0;
    for (int i = 0; i < MeshNode::kWidth; i += kStep) {
        const auto below = (Lanes::FromBytes(node.lower[0] + i) <= Lanes(high[0])) &
                           (Lanes::FromBytes(node.lower[1] + i) <= Lanes(high[1])) &
                           (Lanes::FromBytes(node.lower[2] + i) <= Lanes(high[2]));
        const auto above = (Lanes::FromBytes(node.upper[0] + i) >= Lanes(low[0])) &
                           (Lanes::FromBytes(node.upper[1] + i) >= Lanes(low[1])) &
                           (Lanes::FromBytes(node.upper[2] + i) >= Lanes(low[2]));
        bits |= (below & above).ToBits() << i;
    }
    return bits & ((1u << node.ChildCount()) - 1u);
}

template <class Leaf>
void MeshTree::SearchBox(const Bounds& box, Leaf&& leaf) const {
    uint32_t stack[kMaxStack];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const MeshNode& node = nodes[stack[--top]];
        const uint32_t hits = OverlappingChildren(node, box);
        const uint32_t inner = (1u << node.NodeCount()) - 1u;
        for (uint32_t bits = hits & ~inner; bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            leaf(node.LeafBegin(i), node.LeafEnd(i));
        }
        for (uint32_t bits = hits & inner; bits != 0; bits &= bits - 1)
            stack[top++] = node.firstChild + static_cast<uint32_t>(std::countr_zero(bits));
    }
}

// The children of a node within a distance of a box, and the squares of their distances, m2.
struct NearChildren {
    uint32_t bits;
    alignas(32) float square[MeshNode::kWidth];
};

inline void MeasureChildren(const MeshNode& node, const Bounds& box, const Vector3& scale, float maxSquare,
                            NearChildren& near) {
    using mesh_lanes::Lanes, mesh_lanes::kStep;
    near.bits = 0;
    for (int i = 0; i < MeshNode::kWidth; i += kStep) {
        Lanes sum(0.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const float lower = box.lower[axis], upper = box.upper[axis], origin = node.origin[axis],
                        pad = 0x1p-22f * (Abs(lower) + Abs(upper) + Abs(origin));  // covers the rounding
            const Lanes step(node.Step(axis));
            const Lanes above = Lanes::FromBytes(node.lower[axis] + i) * step + Lanes(origin - upper - pad),
                        below = Lanes(lower - origin - pad) - Lanes::FromBytes(node.upper[axis] + i) * step;
            const Lanes gap = Max(Max(above, below), Lanes(0.0f)) * Lanes(scale[axis]);
            sum += gap * gap;
        }
        near.bits |= (sum <= Lanes(maxSquare)).ToBits() << i;
        sum.Store(near.square + i);
    }
    near.bits &= (1u << node.ChildCount()) - 1u;
}

template <class Leaf>
void MeshTree::SearchNear(const Bounds& box, const Vector3& scale, const float& maxDistance, Leaf&& leaf) const {
    // A node; or a leaf: which child of it.
    struct Entry {
        float square;
        uint32_t node;
        int leaf;
    };
    Entry stack[kMaxStack];
    int top = 0;
    stack[top++] = {0, 0, -1};
    while (top > 0) {
        const Entry entry = stack[--top];
        const float maxSquare = SquareOfReach(maxDistance);
        if (!(entry.square <= maxSquare)) continue;
        const MeshNode& node = nodes[entry.node];
        if (entry.leaf >= 0) {
            leaf(node.LeafBegin(entry.leaf), node.LeafEnd(entry.leaf));
            continue;
        }
        NearChildren near;
        MeasureChildren(node, box, scale, maxSquare, near);
        for (const int base = top; near.bits != 0; near.bits &= near.bits - 1) {
            const int i = std::countr_zero(near.bits);
            int at = top++;  // the nearest on top
            for (; at > base && stack[at - 1].square < near.square[i]; --at) stack[at] = stack[at - 1];
            stack[at] = i < node.NodeCount() ? Entry{near.square[i], node.firstChild + static_cast<uint32_t>(i), -1}
                                             : Entry{near.square[i], entry.node, i};
        }
    }
}

// The children of a node that a ray hits, and the fractions at which it enters them.
struct HitChildren {
    uint32_t bits;
    alignas(32) float entry[MeshNode::kWidth];
};

inline void IntersectChildren(const MeshNode& node, const MeshTreeRay& ray, float maxFraction, HitChildren& hit) {
    using mesh_lanes::Lanes, mesh_lanes::kStep;
    const uint8_t* nearBytes[3];
    const uint8_t* farBytes[3];
    float nearSlope[3], farSlope[3], nearStart[3], farStart[3];
    for (int axis = 0; axis < 3; ++axis) {
        const bool forward = ray.nearInverse[axis] >= 0;
        nearBytes[axis] = forward ? node.lower[axis] : node.upper[axis];
        farBytes[axis] = forward ? node.upper[axis] : node.lower[axis];
        const float step = node.Step(axis);
        nearSlope[axis] = step * ray.nearInverse[axis];
        farSlope[axis] = step * ray.farInverse[axis];
        nearStart[axis] = (node.origin[axis] - ray.nearOrigin[axis]) * ray.nearInverse[axis];
        farStart[axis] = (node.origin[axis] - ray.farOrigin[axis]) * ray.farInverse[axis];
    }
    hit.bits = 0;
    for (int i = 0; i < MeshNode::kWidth; i += kStep) {
        Lanes enter[3], leave[3];
        for (int axis = 0; axis < 3; ++axis) {
            enter[axis] = Lanes(nearSlope[axis]) * Lanes::FromBytes(nearBytes[axis] + i) + Lanes(nearStart[axis]);
            leave[axis] = Lanes(farSlope[axis]) * Lanes::FromBytes(farBytes[axis] + i) + Lanes(farStart[axis]);
        }
        const Lanes first = Max(Max(enter[0], enter[1]), Max(enter[2], Lanes(0.0f)));
        const Lanes last = Min(Min(leave[0], leave[1]), Min(leave[2], Lanes(maxFraction)));
        first.Store(hit.entry + i);
        hit.bits |= (first <= last).ToBits() << i;
    }
    hit.bits &= (1u << node.ChildCount()) - 1u;
}

template <class Leaf>
void MeshTree::SearchRay(const MeshTreeRay& ray, float maxFraction, Leaf&& leaf) const {
    // A node; or a leaf: which child of it.
    struct Entry {
        float fraction;
        uint32_t node;
        int leaf;
    };
    constexpr float kSlack = 1.0f + 0x1p-18f;
    Entry stack[kMaxStack];
    Entry current{0, 0, -1};
    int top = 0;
    for (;;) {
        const MeshNode& node = nodes[current.node];
        if (current.leaf >= 0) {
            maxFraction = leaf(node, current.leaf);
            if (maxFraction < 0) return;
        } else {
            HitChildren hit;
            IntersectChildren(node, ray, maxFraction * kSlack, hit);
            const auto entryOf = [&](int i) {
                if (i < node.NodeCount()) return Entry{hit.entry[i], node.firstChild + static_cast<uint32_t>(i), -1};
                return Entry{hit.entry[i], current.node, i};
            };
            const auto takeLowest = [&] {
                const int i = __builtin_ctz(hit.bits);
                hit.bits &= hit.bits - 1;
                return entryOf(i);
            };
            if (std::has_single_bit(hit.bits)) {
                current = takeLowest();
                continue;
            }
            for (const int base = top; hit.bits != 0;) {
                const Entry child = takeLowest();
                int at = top++;  // the nearest on top
                for (; at > base && stack[at - 1].fraction < child.fraction; --at) stack[at] = stack[at - 1];
                stack[at] = child;
            }
        }
        do {
            if (top == 0) return;
            current = stack[--top];
        } while (current.fraction > maxFraction * kSlack);
    }
}

}  // namespace fulcrum
