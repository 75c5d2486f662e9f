// Rays, moving boxes and nearest boxes in a BoundsTree. Used by the queries; any number of threads at once. Allocates
// nothing.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Collision/BroadPhase/RayLanes.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

// A box that moves from `origin` to origin + displacement. The origin is exact: the box is widened by its rounding to
// float.
class TreeRay {
public:
    TreeRay(const Position& origin, const Vector3& displacement, const Vector3& halfExtents = Vector3::Zero()) {
        constexpr float kLeast = 1e-30f;  // m: smaller displacements count as this, so that the inverse is finite
        for (int axis = 0; axis < 3; ++axis) {
            toLower[axis] = RoundUp(origin[axis] + double{halfExtents[axis]});
            toUpper[axis] = RoundDown(origin[axis] - double{halfExtents[axis]});
            const float d = displacement[axis];
            inverse[axis] = 1 / (Abs(d) < kLeast ? std::copysign(kLeast, d) : d);
        }
    }

    // The fraction of the displacement, 0 or more, at which it enters a box that it hits.
    float EntryInto(const Bounds& box) const {
        float enter = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const float lower = (box.lower[axis] - toLower[axis]) * inverse[axis],
                        upper = (box.upper[axis] - toUpper[axis]) * inverse[axis];
            enter = std::max(enter, std::min(lower, upper));
        }
        return enter;
    }

private:
    friend class BoundsTree;
    friend class TreeRays;
    // Bounds three roundings of half a unit in the last place: of the plane's distance, the inverse and their product.
    static constexpr float kSlack = 1 + 0x1p-21f;
    float toLower[3], toUpper[3];  // m: the moving box's upper and lower corner at the start
    float inverse[3];
};

// Several rays in the same coordinates, tested against the boxes of the tree with the same arithmetic.
class TreeRays {
public:
    void Add(const TreeRay& ray, float maxFraction) { lanes_.Add(ray.toLower, ray.toUpper, ray.inverse, maxFraction); }
    void SetLimit(int ray, float maxFraction) { lanes_.limit[ray] = maxFraction; }
    const float* Limits() const { return lanes_.limit; }
    float LargestLimit() const { return lanes_.LargestLimit(); }
    uint32_t Intersecting(const Bounds& box) const {
        const float lower[3] = {box.lower.x(), box.lower.y(), box.lower.z()},
                    upper[3] = {box.upper.x(), box.upper.y(), box.upper.z()};
        return lanes_.Intersecting(lower, upper, TreeRay::kSlack);
    }

private:
    RayLanes lanes_;
};

// The slots that the ray hits, and the fractions at which it enters them. Empty slots may be among them.
inline uint32_t BoundsTree::CastToSlots(const Node& node, const TreeRay& ray, float maxFraction,
                                        float (&nearest)[kWidth]) {
    constexpr int kStep = kLanes >= 8 ? 8 : 4;
    using Lanes = Wide<kStep>;
    uint32_t bits = 0;
    for (int i = 0; i < kWidth; i += kStep) {
        Lanes enter(0.0f), leave(maxFraction);
        for (int axis = 0; axis < 3; ++axis) {
            const Lanes inverse(ray.inverse[axis]);
            const Lanes toLower = (Lanes::Load(node.lower[axis] + i) - Lanes(ray.toLower[axis])) * inverse;
            const Lanes toUpper = (-Lanes::Load(node.negatedUpper[axis] + i) - Lanes(ray.toUpper[axis])) * inverse;
            enter = Max(enter, Min(toLower, toUpper));
            leave = Min(leave, Max(toLower, toUpper));
        }
        bits |= (enter <= leave * Lanes(TreeRay::kSlack)).ToBits() << i;
        enter.Store(nearest + i);
    }
    return bits;
}

// The slots within the distance of a box, by its square; limit = {upper, -lower}.
inline uint32_t BoundsTree::MeasureSlots(const Node& node, const float (&limit)[6], float maxSquare,
                                         float (&square)[kWidth]) {
    constexpr int kStep = kLanes >= 8 ? 8 : 4;
    using Lanes = Wide<kStep>;
    constexpr float kSlack = 1 + 0x1p-20f;
    uint32_t bits = 0;
    for (int i = 0; i < kWidth; i += kStep) {
        Lanes sum(0.0f);
        for (int axis = 0; axis < 3; ++axis) {
            const Lanes above = Lanes::Load(node.lower[axis] + i) - Lanes(limit[axis]);
            const Lanes below = Lanes::Load(node.negatedUpper[axis] + i) - Lanes(limit[3 + axis]);
            const Lanes gap = Max(Max(above, below), Lanes(0.0f));
            sum += gap * gap;
        }
        bits |= (sum <= Lanes(maxSquare * kSlack)).ToBits() << i;
        sum.Store(square + i);
    }
    return bits;
}

template <class Test, class Limit, class Visitor>
void BoundsTree::VisitInOrder(Test&& test, Limit&& limit, Visitor&& visit) const {
    if (size_ == 0) return;
    struct Entry {
        float key;
        uint32_t node;
    };
    Entry stack[kMaxStack];
    int top = 0;
    stack[top++] = {0, kRoot};
    while (top > 0) {
        const Entry entry = stack[--top];
        if (!(entry.key <= limit())) continue;
        const Node& node = nodes_[entry.node];
        float keys[kWidth];
        const uint32_t hits = test(node, keys);
        for (uint32_t leaves = hits & node.leaves; leaves != 0; leaves &= leaves - 1) {
            const int slot = std::countr_zero(leaves);
            if (keys[slot] <= limit()) visit(node.child[slot]);
        }
        // Sorted in place on the stack, the nearest on top.
        const int base = top;
        for (uint32_t inner = hits & node.inner; inner != 0; inner &= inner - 1) {
            const int slot = std::countr_zero(inner);
            int place = top++;
            for (; place > base && stack[place - 1].key < keys[slot]; --place) stack[place] = stack[place - 1];
            stack[place] = {keys[slot], node.child[slot]};
        }
    }
}

template <class Visitor>
void BoundsTree::CastRay(const TreeRay& ray, float& maxFraction, Visitor&& visit) const {
    VisitInOrder([&](const Node& node, float(&keys)[kWidth]) { return CastToSlots(node, ray, maxFraction, keys); },
                 [&] { return maxFraction * TreeRay::kSlack; }, visit);
}

template <class Visitor>
void BoundsTree::VisitNear(const Bounds& box, const float& maxDistance, Visitor&& visit) const {
    const float limit[6] = {box.upper.x(),  box.upper.y(),  box.upper.z(),
                            -box.lower.x(), -box.lower.y(), -box.lower.z()};
    const auto square = [&] { return maxDistance < 0 ? -1.0f : maxDistance * maxDistance; };
    VisitInOrder([&](const Node& node, float(&keys)[kWidth]) { return MeasureSlots(node, limit, square(), keys); },
                 [&] { return square() * (1 + 0x1p-20f); }, visit);
}

}  // namespace fulcrum
