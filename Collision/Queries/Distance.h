// Closest points of two shapes, overlap, and points inside. Called by the world's queries and by users who have shapes
// and no world. Thread-safe; allocates nothing unless the depth of a degenerate overlap is measured, or with the method
// Libccd. Half spaces have closed forms with either method.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Queries/SubShape.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

struct ClosestPoints {
    float distance = 0;                // m; negative if convex pieces overlap: minus the depth of the deepest pair
    Vector3 normal = Vector3::Zero();  // unit, from A towards B, A's frame
    Vector3 onA = Vector3::Zero();     // m, A's frame
    Vector3 onB = Vector3::Zero();
    SubShape subShapeOfA{}, subShapeOfB{};
};

// What a measured distance may be off due to rounding (m), as may the distance at which a search proves that shapes are
// farther apart than its reach: `size` in m, of the larger shape. Searches that compare distances go this far beyond
// the best one, or what they find would depend on their order.
inline float RoundingOfDistances(float size) { return 1e-6f * size; }

// Finds the closest points, `bInA` being the pose of b's center frame in a's. Returns false if the distance exceeds
// maxDistance (m, >= 0, may be infinite) or 1e18 m, or is not finite. Ties are resolved by the lowest child and
// triangle of A, then of B. A triangle has no inside. Two half spaces that are not opposite overlap without a finite
// depth: the distance is 0.
bool FindClosestPoints(const Shape& a, const Shape& b, const RelativePose& bInA, float maxDistance,
                       ClosestPoints& result, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);
// From a point in the center frame of the shape, which is A.
bool FindClosestPoint(const Shape& shape, const Vector3& point, float maxDistance, ClosestPoints& result,
                      NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

// Whether the two have a point in common; touching counts.
bool Overlap(const Shape& a, const Shape& b, const RelativePose& bInA,
             NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);
// Whether a point in the shape's center frame is inside it or on its surface. Meshes and height fields have no inside.
bool Contains(const Shape& shape, const Vector3& point, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

}  // namespace fulcrum
