// Closest points of two shapes, overlap, and points inside. Called by the world's queries and by users who have shapes
// and no world. Thread-safe; allocates nothing unless the depth of a degenerate overlap is measured, or with the method
// Libccd. Half spaces have closed forms with either method.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Queries/SubShape.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

struct ClosestPoints {
    float distance = 0;  // m; negative where convex pieces overlap: the depth of the pair that overlaps the deepest
    Vector3 normal = Vector3::Zero();  // unit, from A towards B, A's frame
    Vector3 onA = Vector3::Zero();     // m, A's frame
    Vector3 onB = Vector3::Zero();
    SubShape subShapeOfA{}, subShapeOfB{};
};

// Where the two are closest, `bInA` being the pose of b's center frame in a's; false: farther apart than maxDistance
// (m, >= 0, may be infinite), or not finite, or more than 1e18 m. Of pairs equally close that of the lowest child and
// triangle of A, then of B. A triangle has no inside. Two half spaces that are not opposite overlap without a depth:
// the distance is 0.
bool FindClosestPoints(const Shape& a, const Shape& b, const RelativePose& bInA, float maxDistance,
                       ClosestPoints& result, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);
// From a point of the shape's center frame, which is A.
bool FindClosestPoint(const Shape& shape, const Vector3& point, float maxDistance, ClosestPoints& result,
                      NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

// Whether the two have a point in common; touching counts.
bool Overlap(const Shape& a, const Shape& b, const RelativePose& bInA,
             NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);
// Whether a point of the shape's center frame is inside it, or on its surface. Nothing is inside a mesh or a height
// field.
bool Contains(const Shape& shape, const Vector3& point, NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);

}  // namespace fulcrum
