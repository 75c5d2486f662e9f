// Adds speculative points of adjacent faces to contacts of edges or vertices: a body that turns within the step may
// land on those faces. Used by the contact builders. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>

namespace fulcrum {

// The least cosine between a face's normal and the manifold's: steeper faces are ignored.
inline constexpr float kLeastCosineAhead = 0.5f;

// Adds to a manifold of one or two points those of `count` others, pointAt(0) to pointAt(count - 1), whose separation
// is at most `reach`, m; at most four in all. Points within `apart` meters of an existing one are left out.
template <int kMost, class PointAt>
void AddPointsAhead(int count, const PointAt& pointAt, float reach, float apart, float depthSlop,
                    const PointWeights& weighting, Manifold& manifold) {
    const Vector3 tangentU = Perpendicular(manifold.normal), tangentV = Cross<float>(manifold.normal, tangentU);
    const ManifoldPoint known[2] = {manifold.points[0], manifold.points[1]};
    const int knownCount = manifold.pointCount;
    FlatPoints<kMost> points;
    int source[kMost];
    const auto add = [&](const ManifoldPoint& point, int from) {
        source[points.count] = from;
        points.Add(Dot(tangentU, point.positionOnA), Dot(tangentV, point.positionOnA), point.separation);
    };
    for (int i = 0; i < knownCount; ++i) add(known[i], i);
    for (int i = 0; i < count && points.count < kMost; ++i) {
        const ManifoldPoint point = pointAt(i);
        bool isNew = point.separation <= reach;
        for (int k = 0; k < knownCount; ++k)
            isNew = isNew && LengthSquared(Vector3(point.positionOnA - known[k].positionOnA)) > apart * apart;
        if (isNew) add(point, i);
    }
    int chosen[Manifold::kMaxPoints];
    manifold.pointCount = ChooseFour(points, depthSlop, chosen, weighting);
    for (int i = 0; i < manifold.pointCount; ++i)
        manifold.points[i] = chosen[i] < knownCount ? known[chosen[i]] : pointAt(source[chosen[i]]);
}

}  // namespace fulcrum
