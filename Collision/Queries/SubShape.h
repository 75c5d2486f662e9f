// The child or triangle of a shape that a query found.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <compare>

namespace fulcrum {

struct SubShape {
    uint32_t child = 0;               // of a compound; 0 for any other shape
    uint32_t triangle = kNoTriangle;  // of a mesh or height field
    friend auto operator<=>(const SubShape&, const SubShape&) = default;
};

}  // namespace fulcrum
