// Intersections of a line with a convex shape. Called by the ray casts. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// A segment of a line with parameter s: point + s direction, from <= s <= to. `point` is near the shape's center, so
// that floats are precise however far away the segment begins.
struct LinePiece {
    Vector3 point;      // m, in the shape's center frame
    Vector3 direction;  // unit
    float from, to;     // m
};

struct LineHit {
    float distance = 0;                // s, m
    Vector3 normal = Vector3::Zero();  // unit, outwards
};

struct LineResult {
    bool hit = false;
    bool startsInside = false;
    LineHit entry;  // if hit and not startsInside
};

// The entry into the shape, or startsInside (touching counts). Sphere, box, capsule and hull in closed form, others by
// EnterBySupport.
LineResult EnterConvex(const ConvexShape& shape, const LinePiece& line);
// By GJK on the support function alone.
LineResult EnterBySupport(const ConvexShape& shape, const LinePiece& line);

// Where a line that begins inside leaves the shape; returns false if not within the segment.
bool LeaveConvex(const ConvexShape& shape, const LinePiece& line, LineHit& exit);

}  // namespace fulcrum
