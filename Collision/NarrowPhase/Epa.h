// Depth of two overlapping cores by expanding a polytope inside their Minkowski difference towards its boundary
// (G. van den Bergen, Proximity Queries and Penetration Depth Computation on 3D Game Objects, GDC 2001). A template
// over the pair, as GJK is. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Polytope.h>

namespace fulcrum {

struct EpaResult {
    // Failed: degenerate input, no axis. Approximate: the polytope is full or rounding stopped it, the axis is the best
    // so far.
    enum class Status { Failed, Approximate, Found };
    Status status;
    Vector3 axis;      // unit, from A towards B
    float separation;  // m along the axis, <= 0
};

// `simplex`: what GJK ended with. The result is the axis of least depth to within the pair's DepthTolerance().
template <class Pair>
EpaResult Epa(const Pair& pair, const Simplex<typename Pair::Vertex>& simplex) {
    using Real = typename Pair::Vertex::Real;
    constexpr int kMaxIterations = 80;
    const float tolerance = pair.DepthTolerance();
    EpaResult result{EpaResult::Status::Failed, Vector3::Zero(), 0};
    Polytope<Pair> polytope;
    if (!polytope.Start(pair, simplex, 10 * tolerance)) return result;
    for (int i = 0; i < kMaxIterations; ++i) {
        const auto face = polytope.ClosestFace();
        if (face.distance < -10 * tolerance) return result;  // rounding has inverted a face
        const Vector3 axis = -face.normal.template cast<float>();
        const typename Pair::Vertex vertex = pair.Support(axis);
        const float farthest = static_cast<float>(Dot<Real>(face.normal, vertex.w));
        if (result.status == EpaResult::Status::Failed || -farthest > result.separation)
            result = {EpaResult::Status::Approximate, axis, -farthest};
        if (farthest - static_cast<float>(face.distance) <= tolerance || polytope.HasVertex(vertex)) {
            result = {EpaResult::Status::Found, axis, -farthest};
            return result;
        }
        if (!polytope.Add(vertex, tolerance)) return result;
    }
    return result;
}

}  // namespace fulcrum
