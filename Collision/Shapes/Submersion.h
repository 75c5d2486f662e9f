// How much of a convex shape lies below a plane, and where its middle is: what buoyancy needs. Pure functions, any
// thread; allocates nothing.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

struct SubmergedPart {
    double volume = 0;                   // m3
    Position center = Position::Zero();  // m, of the volume, in the shape's center frame; zero where there is none
};

// The part of a shape where up . x <= level, in its center frame; `up` is a unit vector, level in m. Balls, boxes and
// hulls: exact, by closed forms and by clipping their faces. Capsules, cylinders, cones and their tapered forms: to
// about 1e-6 of the volume, by slices (Gauss-Legendre between the heights where these are cut, not cut or left out).
// Custom shapes: as if they were ellipsoids of the same volume between the same two planes. Rounded hulls: the core's
// part, scaled to the mass's volume. What has no volume has no part.
SubmergedPart Submerged(const ConvexShape& shape, const Vector3& up, double level);

// The area, m2, that a shape shows to a wind along a unit vector of its center frame. Balls, boxes, hulls, capsules
// and cylinders exactly; others as the box of their bounds.
float ShadowArea(const ConvexShape& shape, const Vector3& direction);

}  // namespace fulcrum
