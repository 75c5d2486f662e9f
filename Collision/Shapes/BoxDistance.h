// Distances of boxes, for searches of what is near a box: by MeshTree and HeightField. Free functions, no state.
#pragma once

#include <Fulcrum/Math/Bounds.h>

namespace fulcrum {

// m2; 0 where the boxes overlap.
inline float SquaredDistance(const Bounds& a, const Bounds& b) {
    return LengthSquared(Vector3(a.lower - b.upper).cwiseMax(Vector3(b.lower - a.upper)).cwiseMax(0.0f));
}

// The square of the largest distance that a search looks for, enlarged by the rounding; negative: it has ended.
inline float SquareOfReach(float maxDistance) {
    return maxDistance < 0 ? -1.0f : maxDistance * maxDistance * (1 + 0x1p-18f);
}

}  // namespace fulcrum
