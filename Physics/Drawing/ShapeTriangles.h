// The surface of a shape as triangles, to be drawn. Pure; any thread.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Jobs/JobSystem.h>

namespace fulcrum {

struct DrawnTriangle {
    Vector3 corners[3];    // m, counter-clockwise seen from outside, or from the front of a surface
    uint8_t material = 0;  // of a surface: index into its materials
};

// Calls visit for the triangles of a shape, in the frame in which the user described it. Boxes, hulls, meshes and
// height fields as they are; round shapes by 8 * 4^detail triangles whose corners are on the surface (0..6, clamped: 3
// has an error of about 1 % of the radius); a plane as a square of side 2 * planeExtent m, > 0; each child of a
// compound.
void VisitTriangles(const Shape& shape, FunctionRef<void(const DrawnTriangle&)> visit, int detail = 3,
                    float planeExtent = 100);

}  // namespace fulcrum
