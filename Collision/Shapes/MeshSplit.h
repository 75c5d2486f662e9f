// Splits sets of boxes for the builder of mesh trees. Used by MeshBuilder alone.
#pragma once

#include <Fulcrum/Collision/Shapes/ParallelLoop.h>
#include <Fulcrum/Math/Bounds.h>
#include <Fulcrum/Math/Wide.h>

#include <bit>
#include <limits>
#include <span>

namespace fulcrum {

// A triangle's box as {lower, -, -upper, -}, so that the union is the lane-wise minimum, and its number.
struct alignas(32) TriangleBox {
    float lane[8];
    uint32_t Id() const { return std::bit_cast<uint32_t>(lane[3]); }
    // Twice the center.
    float Center(int axis) const { return lane[axis] - lane[4 + axis]; }
};

// A union of boxes in the same form.
struct BoxUnion {
    Wide<8> v{std::numeric_limits<float>::infinity()};
    void Include(const BoxUnion& other) { v = Min(v, other.v); }
    void Include(const TriangleBox& box) { v = Min(v, Wide<8>::Load(box.lane)); }
    float HalfArea() const {
        const float x = -v[4] - v[0], y = -v[5] - v[1], z = -v[6] - v[2];
        return x * y + y * z + z * x;
    }
    Bounds ToBounds() const {
        Bounds bounds;
        bounds.lower = Vector3(v[0], v[1], v[2]);
        bounds.upper = Vector3(-v[4], -v[5], -v[6]);
        return bounds;
    }
};

// A range of the builder's boxes.
struct BoxSet {
    uint32_t begin, end;
    BoxUnion box;
    uint32_t Count() const { return end - begin; }
};

BoxUnion UnionOf(std::span<const TriangleBox> boxes, const ParallelLoop& parallel);

// Constraints of a split: at least `smallest` on each side; and if `leaf` is not 0, the two sides together need at most
// `mostLeaves` leaves of that size.
struct SplitRules {
    uint32_t smallest = 1;
    uint32_t leaf = 0;
    uint32_t mostLeaves = 0;
    bool byCount = false;  // split by count, independent of the boxes
    bool Allow(uint32_t left, uint32_t right) const {
        return left >= smallest && right >= smallest &&
               (leaf == 0 || (left + leaf - 1) / leaf + (right + leaf - 1) / leaf <= mostLeaves);
    }
};

// Partitions the set, of at least two boxes, into two sides. The resulting order depends only on the boxes.
void Split(std::span<TriangleBox> boxes, const BoxSet& set, const SplitRules& rules, const ParallelLoop& parallel,
           BoxSet& left, BoxSet& right);

}  // namespace fulcrum
