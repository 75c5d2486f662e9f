// A mesh inscribed in a convex shape, from its support function alone. Used for the mass properties of user-defined
// shapes and for drawing. Pure; thread-safe; allocates its result.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <vector>

namespace fulcrum {

struct SampledSurface {
    std::vector<Vector3> vertices;  // in the shape's center frame, m
    std::vector<int> indices;       // three per triangle, counter-clockwise seen from outside; some have no area
};

// The directions to a grid of `divisions` x `divisions` squares (1 .. 1000) on each side of a cube, each taken to the
// point of the whole shape that lies farthest along it. Flat faces and edges of the shape are exact, curved ones
// inscribed.
SampledSurface SampleSurface(const ConvexShape& shape, int divisions);

}  // namespace fulcrum
