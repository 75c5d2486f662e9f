// Limits of the coordinates of meshes, height fields and planes.
#pragma once

#include <cstdint>

namespace fulcrum {

inline constexpr float kLargestCoordinate = 1e15f;  // m: products of two sizes and their sums are floats
inline constexpr double kThinnestTriangle = 1e-6;   // height over longest edge: below, float gives no usable normal
inline constexpr uint32_t kMostTriangles = 1u << 27;

inline constexpr float kSmallestScale = 1e-6f, kLargestScale = 1e6f;

}  // namespace fulcrum
