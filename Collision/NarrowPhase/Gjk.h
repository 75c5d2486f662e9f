// Distance between two convex cores by the algorithm of Gilbert, Johnson and Keerthi (IEEE J. Robotics and Automation
// 4(2), 1988), warm started from an axis. A template over the pair: PolyhedronPair for CollidePolyhedra, SupportPair
// for shapes given by support functions. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/SimplexSearch.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace fulcrum {

enum class GjkStatus : uint8_t { BeyondReach, Apart, Overlapping };

template <class Vertex>
struct GjkResult {
    GjkStatus status;
    Vector3 axis;             // unit, from A towards B; the separating axis, or that of the closest points
    float separation;         // m along the axis: a lower bound of the distance where beyond reach, else the distance
    Simplex<Vertex> simplex;  // apart: spans the closest point; overlapping: 1 to 4 vertices around or at the origin
    // Apart: whether the axis separates the cores by that distance. False if rounding ended the search before.
    bool converged = true;
};

// `start`: a unit vector, the guess of the axis. Ends as soon as the cores are found to be farther apart than `reach`.
// Pair has Vertex, Support(axis), SeparationAlong(axis) and Size().
template <class Pair>
GjkResult<typename Pair::Vertex> Gjk(const Pair& pair, const Vector3& start, float reach) {
    constexpr int kMaxIterations = 40;
    using Real = typename Pair::Vertex::Real;
    const Real touching = 1e-6f * pair.Size() + 1e-12f;
    GjkResult<typename Pair::Vertex> result{GjkStatus::Apart, start, 0, {}, true};
    Simplex<typename Pair::Vertex>& simplex = result.simplex;
    Vec3<Real> axis = start.cast<Real>();
    Real distance = -1;  // of the closest point so far; negative: none yet
    Real gap = 0;        // by how much the separation along the last axis falls short of that
    for (int i = 0; i < kMaxIterations; ++i) {
        const typename Pair::Vertex vertex = pair.Support(Vector3(axis.template cast<float>()));
        const Real bound = Dot<Real>(axis, vertex.w);
        if (bound > reach) {
            result.status = GjkStatus::BeyondReach;
            result.axis = axis.template cast<float>();
            result.separation = static_cast<float>(bound);
            return result;
        }
        gap = distance - bound;
        if (distance >= 0 && (gap <= Real(1e-6f) * distance || Contains(simplex, vertex))) break;
        Simplex<typename Pair::Vertex> next = simplex;
        next.vertices[next.count++] = vertex;
        const Vec3<Real> closest = ClosestOn(next);
        const Real closer = std::sqrt(LengthSquaredOf<Real>(closest));
        if (closer <= touching || next.count == 4) {
            result.status = GjkStatus::Overlapping;
            simplex = next;
            return result;
        }
        // No progress, by rounding: this is the closest point. The last vertex may still improve the axis a little.
        const bool last = distance >= 0 && closer >= distance;
        if (last && closer > distance * Real(1.000001f)) break;
        simplex = next;
        distance = closer;
        axis = closest * (1 / closer);
        if (last) {
            gap = distance - Real(pair.SeparationAlong(Vector3(axis.template cast<float>())));
            break;
        }
    }
    result.axis = axis.template cast<float>();
    result.separation = static_cast<float>(distance);
    // So close that rounding spoils the direction: the axis does not separate the cores by the distance of the points.
    if (gap > 100 * touching && distance < 1000 * touching) result.status = GjkStatus::Overlapping;
    result.converged = gap <= std::max(100 * touching, Real(1e-3f) * distance);
    return result;
}

}  // namespace fulcrum
