// Volume and area of a convex hull by Qhull, the reference of the hull tests.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <optional>
#include <span>

namespace fulcrum::test {

struct HullSize {
    double volume, area;
};

// Nothing where Qhull finds the points degenerate.
std::optional<HullSize> QhullSize(std::span<const Position> points);

}  // namespace fulcrum::test
