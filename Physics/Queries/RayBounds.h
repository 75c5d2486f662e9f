// Bounding boxes of the origins and displacements of a set of rays, which tell how coherent they are. Used by batches
// of ray casts. Pure functions.
#pragma once

#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Math/Bounds.h>

#include <algorithm>

namespace fulcrum {

struct RayBounds {
    Position low = Position::Constant(kFar), high = Position::Constant(-kFar);
    Bounds displacements;

    // Half extents of a box, centered at the middle of the origins, that contains all rays.
    Vector3 Reach() const { return Vector3(Position((high - low) * 0.5).cast<float>()) + displacements.HalfExtents(); }
    // Whether the box is so small relative to the rays' length that a packet query will find few colliders that no
    // single ray hits. False if a ray is not finite, or so long that sums overflow: then the rays are cast one by one.
    bool IsTight() const {
        const float way = displacements.Center().cwiseAbs().sum();
        return way < kLongest && Reach().sum() <= kTight * way;
    }

    static constexpr float kTight = 0.45f, kLongest = 1e18f;  // m
    static constexpr double kFar = 1e300;

    // Bounds of rayOf(i) for i < count. NaN is ignored.
    template <class RayOf>
    static RayBounds Of(size_t count, const RayOf& rayOf) {
        double low[6], high[6];
        for (int k = 0; k < 6; ++k) low[k] = kFar, high[k] = -kFar;
        for (size_t i = 0; i < count; ++i) {
            const Ray& ray = rayOf(i);
            for (int k = 0; k < 6; ++k) {
                const double at = k < 3 ? ray.origin[k] : double{ray.displacement[k - 3]};
                low[k] = std::min(low[k], at);
                high[k] = std::max(high[k], at);
            }
        }
        RayBounds bounds;
        bounds.low = Position(low[0], low[1], low[2]);
        bounds.high = Position(high[0], high[1], high[2]);
        bounds.displacements.lower = Position(low[3], low[4], low[5]).cast<float>();
        bounds.displacements.upper = Position(high[3], high[4], high[5]).cast<float>();
        return bounds;
    }
};

}  // namespace fulcrum
