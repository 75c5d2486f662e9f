// Axis-aligned bounding boxes. Bounds (float) is for shapes in their own frame and for the broad phase. Boxes in double
// are rounded outwards to float, so that they are contained at any distance from the origin.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <bit>
#include <cstdint>
#include <limits>

namespace fulcrum {

struct Bounds {
    Vector3 lower = Vector3::Constant(std::numeric_limits<float>::infinity());
    Vector3 upper = Vector3::Constant(-std::numeric_limits<float>::infinity());

    bool IsEmpty() const { return !(lower.x() <= upper.x()); }
    Vector3 Center() const { return (lower + upper) * 0.5f; }
    Vector3 HalfExtents() const { return (upper - lower) * 0.5f; }
    void Include(const Vector3& p) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    void Include(const Bounds& b) {
        lower = lower.cwiseMin(b.lower);
        upper = upper.cwiseMax(b.upper);
    }
    bool Overlaps(const Bounds& b) const {
        return lower.x() <= b.upper.x() && b.lower.x() <= upper.x() && lower.y() <= b.upper.y() &&
               b.lower.y() <= upper.y() && lower.z() <= b.upper.z() && b.lower.z() <= upper.z();
    }
    bool Contains(const Bounds& b) const {
        return lower.x() <= b.lower.x() && b.upper.x() <= upper.x() && lower.y() <= b.lower.y() &&
               b.upper.y() <= upper.y() && lower.z() <= b.lower.z() && b.upper.z() <= upper.z();
    }
    // Half the surface area: the cost of a tree's node (SAH).
    float HalfArea() const {
        const Vector3 d = upper - lower;
        return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    }
};

// The largest float not above x, and the smallest not below; NaN stays one. Without branches: half of them would be
// mispredicted.
inline float RoundDown(double x) {
    const float f = static_cast<float>(x);
    const auto bits = std::bit_cast<uint32_t>(f);
    const uint32_t isZero = -static_cast<uint32_t>((bits << 1) == 0),
                   isNegative = -(bits >> 31);  // all bits set, or none
    const uint32_t below = (isZero & 0x80000001u) | (~isZero & (bits - 1u - 2u * isNegative));
    const uint32_t isAbove = -static_cast<uint32_t>(double{f} > x);
    return std::bit_cast<float>((isAbove & below) | (~isAbove & bits));
}
inline float RoundUp(double x) { return -RoundDown(-x); }

// The float box around a double one, rounded outwards.
inline Bounds RoundedOutwards(const Position& lower, const Position& upper) {
    Bounds b;
    b.lower = Vector3(RoundDown(lower.x()), RoundDown(lower.y()), RoundDown(lower.z()));
    b.upper = Vector3(RoundUp(upper.x()), RoundUp(upper.y()), RoundUp(upper.z()));
    return b;
}

}  // namespace fulcrum
