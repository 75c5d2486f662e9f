// Bounds of colliders: the tight ones of where they are, and the fat ones that the trees hold.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>

namespace fulcrum {

// World bounds of a collider where its body is now, without any margin.
Bounds TightBoundsOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider);

// Fat bounds of a collider at its body's pose, at rest.
void SetFatBounds(const SystemSettings& settings, const BodyStore& bodies, ColliderStore& colliders, uint32_t collider);

// Bounds of a shape at a pose about the origin of bounds while it turns by a rotation vector in rad, without any
// margin. A hull as round as a ball is bounded best by its outer sphere.
Bounds TightBounds(const Shape& shape, const Pose& pose, const Matrix3& rotation, const Vector3& turn);

// Of what moves by `motion`, with a margin on all sides.
inline Bounds BoundsAlong(const Bounds& tight, const Vector3& motion, float margin) {
    Bounds b;
    b.lower = tight.lower + motion.cwiseMin(0.0f) - Vector3::Constant(margin);
    b.upper = tight.upper + motion.cwiseMax(0.0f) + Vector3::Constant(margin);
    return b;
}

// m, up to the settings': those of small shapes are a part of their size, so that a pile of grains is to its contacts
// what a pile of boxes is. Fat bounds exceed the shape's by the margin and half the speculative distance.
inline constexpr float kMarginPart = 0.25f;  // of the outer radius
inline float SpeculativeDistance(const SystemSettings& settings, const Shape& shape) {
    return std::min(settings.speculativeDistance, kMarginPart * shape.OuterRadius());
}
inline float BoundsMargin(const SystemSettings& settings, const Shape& shape) {
    return std::min(settings.boundsMargin, kMarginPart * shape.OuterRadius());
}
// Of a pair: the smaller shape's.
inline float SpeculativeDistance(const SystemSettings& settings, const Pair& pair) {
    return std::min(SpeculativeDistance(settings, *pair.shapeA), SpeculativeDistance(settings, *pair.shapeB));
}

}  // namespace fulcrum
