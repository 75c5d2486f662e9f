// The one door to libccd: penetration of two convex shapes through their support functions, in double. The default of
// the pair table, the fallback of the other functions and their measure in tests. libccd allocates; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>

namespace fulcrum {

enum class LibccdAlgorithm : uint8_t { Epa, Mpr };

struct LibccdResult {
    enum class Status { Apart, Found, Failed };
    Status status;
    Position normal;    // unit, from A towards B, in A's frame
    double separation;  // m along the normal, of the whole shapes, <= margin
    Position position;  // m, somewhere where they touch
};

// libccd knows no distance. Each shape is therefore its core, rounded by its convex radius and half of `margin` (m, >=
// 0): shapes up to `margin` apart then overlap, and margin less the depth is their separation.
LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm);

}  // namespace fulcrum
