// Bounds of colliders: tight bounds at the current pose, and fat bounds for the trees.
#pragma once

#include <Fulcrum/Physics/World/PairShapes.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>

namespace fulcrum {

// Bounds of a collider at its body's current pose, without margin.
Bounds TightBoundsOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider);
// The same if its body's center frame, on the grid, were `body`.
Bounds TightBoundsAt(Pose body, const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider);

// Fat bounds of a collider at its body's pose, at rest.
void SetFatBounds(const SystemSettings& settings, const BodyStore& bodies, ColliderStore& colliders, uint32_t collider);

// Bounds of a shape at a pose relative to the origin of bounds while it rotates by a rotation vector, rad, without
// margin. The bounding sphere is used if it is tighter.
Bounds TightBounds(const Shape& shape, const Pose& pose, const Matrix3& rotation, const Vector3& turn);

// Bounds extended by `motion`, with a margin on all sides.
inline Bounds BoundsAlong(const Bounds& tight, const Vector3& motion, float margin) {
    Bounds b;
    b.lower = tight.lower + motion.cwiseMin(0.0f) - Vector3::Constant(margin);
    b.upper = tight.upper + motion.cwiseMax(0.0f) + Vector3::Constant(margin);
    return b;
}

// m, margin and speculative distance of a shape: for small shapes a fraction of their size, so that contacts scale with
// size; at most those of the settings. Fat bounds exceed the shape's by the margin and half the speculative distance.
inline constexpr float kMarginFraction = 0.25f;  // of the outer radius
inline float SpeculativeDistance(const SystemSettings& settings, const Shape& shape) {
    return std::min(settings.speculativeDistance, kMarginFraction * shape.OuterRadius());
}
inline float BoundsMargin(const SystemSettings& settings, const Shape& shape) {
    return std::min(settings.boundsMargin, kMarginFraction * shape.OuterRadius());
}
// For a pair: that of the smaller shape.
inline float SpeculativeDistance(const SystemSettings& settings, PairShapes shapes) {
    return std::min(SpeculativeDistance(settings, shapes.a), SpeculativeDistance(settings, shapes.b));
}

}  // namespace fulcrum
