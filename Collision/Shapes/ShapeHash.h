// Content hash of shapes, by which snapshots reference shapes across programs. Any number of threads.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// 64-bit hash of all data that affect collisions and masses: shapes with equal hashes behave alike. For custom shapes
// it covers mass, bounds and the support points of some hundred directions. Computed by the first call in time
// proportional to the shape's size, then cached, except for a MutableCompound.
uint64_t ContentHash(const Shape& shape);

}  // namespace fulcrum
