// The volume and center of the part of a convex shape below a plane, for buoyancy. Pure functions, any thread;
// allocates nothing.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

struct SubmergedPart {
    double volume = 0;                   // m3
    Position center = Position::Zero();  // m, of the volume, in the shape's center frame; zero if it is empty
};

// The part of a shape where up . x <= level, in its center frame; `up` is a unit vector, level in m. Balls, boxes and
// hulls: exact, by closed forms and by clipping their faces. Capsules, cylinders, cones and their tapered forms: to
// about 1e-6 of the volume, by slices (Gauss-Legendre between the heights where these are cut, not cut or left out).
// Custom shapes: as ellipsoids of the same volume between the same two planes. Rounded hulls: the core's part, scaled
// to the volume of the mass properties. Zero for shapes without volume.
SubmergedPart Submerged(const ConvexShape& shape, const Vector3& up, double level);

// The frontal area, m2, of a shape in a wind along a unit vector of its center frame. Balls, boxes, hulls, capsules
// and cylinders exactly; others as the box of their bounds.
float ShadowArea(const ConvexShape& shape, const Vector3& direction);

}  // namespace fulcrum
