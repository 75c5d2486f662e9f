// What a compound is as a whole, kept up to date as single children change: mass, center, inertia, box and smallest
// radius. Used by MutableCompound. Partial sums of eight, of eight of these, and so on: a change costs the logarithm of
// the number of children, and the result depends on the children and their indices alone, in all its bits, not on how
// they came about.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundShape.h>

namespace fulcrum {

// A child, or several together. Masses are density times volume, at the children's own densities.
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
    // The sum of one child; `bounds` as it lies in the children's frame. Nothing where its shape is null.
    static CompoundSum Of(const CompoundShape::Child& child, const Bounds& bounds);

    void Set(uint32_t index, const CompoundSum& child);  // at most one index beyond the last
    CompoundSum Total() const { return levels_.empty() ? CompoundSum{} : levels_.back().front(); }
    // What the total would be with another child at the index.
    CompoundSum TotalWith(uint32_t index, const CompoundSum& child) const;
    const CompoundSum& At(uint32_t index) const { return levels_.front()[index]; }

private:
    static constexpr uint32_t kWidth = 8;
    // The sum of eight of a level, one of them another.
    CompoundSum SumWith(size_t level, uint32_t index, const CompoundSum& other) const;

    std::vector<std::vector<CompoundSum>> levels_;  // the children, their partial sums, ..., the total
};

}  // namespace fulcrum
