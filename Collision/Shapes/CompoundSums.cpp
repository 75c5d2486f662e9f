#include <Fulcrum/Collision/Shapes/CompoundSums.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>

#include <algorithm>

namespace fulcrum {

CompoundSum CompoundSum::operator+(const CompoundSum& other) const {
    if (!(mass > 0)) return other;
    if (!(other.mass > 0)) return *this;
    CompoundSum sum;
    sum.mass = mass + other.mass;
    sum.volume = volume + other.volume;
    const Position d = other.center - center;
    sum.center = center + d * (other.mass / sum.mass);
    const double reduced = mass * (other.mass / sum.mass);
    const auto add = [](double a, double b, double steiner) { return (a + b) + steiner; };
    const Sym3<double>&i = inertia, &j = other.inertia;
    sum.inertia = {add(i.xx, j.xx, reduced * (d.y() * d.y() + d.z() * d.z())),
                   add(i.yy, j.yy, reduced * (d.x() * d.x() + d.z() * d.z())),
                   add(i.zz, j.zz, reduced * (d.x() * d.x() + d.y() * d.y())),
                   add(i.xy, j.xy, -reduced * (d.x() * d.y())),
                   add(i.xz, j.xz, -reduced * (d.x() * d.z())),
                   add(i.yz, j.yz, -reduced * (d.y() * d.z()))};
    sum.bounds = bounds;
    sum.bounds.Include(other.bounds);
    sum.innerRadius = std::min(innerRadius, other.innerRadius);
    return sum;
}

CompoundSum CompoundSums::Of(const CompoundShape::Child& child, const Bounds& bounds) {
    if (!child.shape) return {};
    SolidMass solid = ToSolidMass(child.shape->Mass());
    solid.center = Position::Zero();
    solid = Transformed(solid, child.pose.rotation, child.pose.position.cast<double>());
    const double density{child.density};
    const Sym3<double>& i = solid.inertia;
    CompoundSum sum;
    sum.mass = density * solid.volume;
    sum.volume = solid.volume;
    sum.center = solid.center;
    sum.inertia = {density * i.xx, density * i.yy, density * i.zz, density * i.xy, density * i.xz, density * i.yz};
    sum.bounds = bounds;
    sum.innerRadius = child.shape->InnerRadius();
    return sum;
}

CompoundSum CompoundSums::SumWith(size_t level, uint32_t index, const CompoundSum& other) const {
    const std::vector<CompoundSum>& sums = levels_[level];
    const uint32_t first = index / kWidth * kWidth;
    const uint32_t end = std::max(index + 1, std::min(first + kWidth, static_cast<uint32_t>(sums.size())));
    CompoundSum sum;
    for (uint32_t i = first; i < end; ++i) sum = sum + (i == index ? other : sums[i]);
    return sum;
}

void CompoundSums::Set(uint32_t index, const CompoundSum& child) {
    CompoundSum sum = child;
    for (size_t level = 0;; ++level) {
        if (level == levels_.size()) levels_.push_back(std::move(next_));
        std::vector<CompoundSum>& sums = levels_[level];
        const bool isNew = index == sums.size();
        if (isNew) sums.push_back(sum);
        else sums[index] = sum;
        // A level with one entry is the total. When it gets a second one, a level is added above it, and its first sum
        // is complete.
        if (sums.size() == 1) return;
        sum = SumWith(level, index, sum);
        index /= kWidth;
    }
}

void CompoundSums::Reserve(size_t children) {
    next_.reserve(kWidth);
    levels_.reserve(levels_.size() + 1);
    for (std::vector<CompoundSum>& level : levels_) {
        level.reserve(children);
        children = (children + kWidth - 1) / kWidth;
    }
}

CompoundSum CompoundSums::TotalWith(uint32_t index, const CompoundSum& child) const {
    CompoundSum sum = child;
    for (size_t level = 0; level < levels_.size(); ++level) {
        if (levels_[level].size() == 1 && index == 0) return sum;
        sum = SumWith(level, index, sum);
        index /= kWidth;
    }
    return sum;
}

}  // namespace fulcrum
