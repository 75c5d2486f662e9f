// The part of a large box (a ground, for example) near a small shape. Contacts with the part are those with the box,
// and GJK and EPA, which work in floats, do not have to resolve a body of a meter against faces of kilometers. Used by
// Collide; lives on the stack of one call.
#pragma once

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

class BoxPart {
public:
    // Cuts out of `box` what lies within 16 times radius + reach, m, of a shape of that outer radius, at `center` in
    // the box's frame, for contacts as far ahead as `reach`. False if the box is at most four times as large, or if the
    // shape is so deep inside that no face of the box is that near; then there is no part.
    bool Cut(const Box& box, const Vector3& center, float radius, float reach) {
        const float extent = kExtent * (radius + reach);
        if (!(box.OuterRadius() > kLarge * extent)) return false;
        const Vector3 h = box.HalfExtents();
        Vector3 halfExtents;
        bool hasFace = false;
        for (int axis = 0; axis < 3; ++axis) {
            const float lower = Max(-h[axis], center[axis] - extent), upper = Min(h[axis], center[axis] + extent);
            if (!(upper - lower > 2 * box.ConvexRadius())) return false;
            hasFace = hasFace || lower == -h[axis] || upper == h[axis];
            halfExtents[axis] = 0.5f * (upper - lower);
            offset_[axis] = 0.5f * (upper + lower);
        }
        if (!hasFace) return false;
        part_.SetSize(halfExtents, box.ConvexRadius());
        return true;
    }
    const Box& Shape() const { return part_; }
    const Vector3& Offset() const { return offset_; }  // of its center, in the box's frame

private:
    static constexpr float kExtent = 16, kLarge = 4;

    Box part_;
    Vector3 offset_ = Vector3::Zero();
};

}  // namespace fulcrum
