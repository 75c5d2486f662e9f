// A mesh inscribed in a convex shape, from its support function alone. Used for the mass properties of shapes that
// users make and for drawing. Pure; thread-safe; allocates what it returns.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <vector>

namespace fulcrum {

struct SampledSurface {
    std::vector<Vector3> vertices;  // in the shape's center frame, m
    std::vector<int> indices;       // three a triangle, counter-clockwise seen from outside; some have no area
};

// The directions to a grid of `divisions` x `divisions` squares (1 .. 1000) on each side of a cube, each taken to the
// point of the whole shape that lies farthest along it. Faces and edges of the shape come out exactly, what is curved
// inscribed.
SampledSurface SampleSurface(const ConvexShape& shape, int divisions);

}  // namespace fulcrum
