// Mass, center of mass, inertia, bounds and smallest radius of all children, updated as single children change. Used by
// MutableCompound. A tree of partial sums, eight to a node: a change takes logarithmic time, and the bits of the result
// depend only on the children and their indices, not on the order of edits.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundShape.h>

namespace fulcrum {

// One child, or the sum of several. Masses are density times volume.
struct CompoundSum {
    double mass = 0;                     // 0: nothing
    double volume = 0;                   // m3
    Position center = Position::Zero();  // of mass, in the children's frame, m
    Sym3<double> inertia;                // about the center, kg m2
    Bounds bounds;                       // in the children's frame
    float innerRadius = 0;               // the smallest child's

    // Parallel axes: the two and m1 m2 / (m1 + m2) (|d|^2 1 - d d^T), d from center to center.
    CompoundSum operator+(const CompoundSum& other) const;
};

class CompoundSums {
public:
    // The sum of a single child; `bounds` in the children's frame. Zero if its shape is null.
    static CompoundSum Of(const CompoundShape::Child& child, const Bounds& bounds);

    void Set(uint32_t index, const CompoundSum& child);  // at most one index beyond the last
    void Reserve(size_t children);                       // for so many in all
    CompoundSum Total() const { return levels_.empty() ? CompoundSum{} : levels_.back().front(); }
    // The total if `child` replaced the one at the index.
    CompoundSum TotalWith(uint32_t index, const CompoundSum& child) const;
    const CompoundSum& At(uint32_t index) const { return levels_.front()[index]; }

private:
    static constexpr uint32_t kWidth = 8;
    // The sum of eight entries of a level, one of them replaced.
    CompoundSum SumWith(size_t level, uint32_t index, const CompoundSum& other) const;

    std::vector<std::vector<CompoundSum>> levels_;  // the children, their partial sums, ..., the total
    std::vector<CompoundSum> next_;                 // empty: the room of the next level
};

}  // namespace fulcrum
