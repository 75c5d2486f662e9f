// Knows a shape again in another program, or after it was made anew: snapshots name shapes so. Any number of threads.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// 64 bits that follow from all that collisions and masses depend on, so that two shapes with the same hash behave
// alike. Of a custom shape its mass, its bounds and the points that lie farthest along some hundred directions. Found
// by the first call in a time in proportion to the shape's size, and kept; not of a MutableCompound, which changes.
uint64_t ContentHash(const Shape& shape);

}  // namespace fulcrum
