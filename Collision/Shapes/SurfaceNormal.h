// The normal of a triangle of a surface. Pure.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cmath>

namespace fulcrum {

// Unit, to the side from which abc run counter-clockwise; along y for a triangle without area. In double if float would
// lose more than a ten-thousandth (slivers) or overflow.
inline Vector3 TriangleNormal(const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 u = b - a, v = c - a;
    const Vector3 cross = Cross<float>(u, v);
    const float squared = Dot(cross, cross), sides = Dot(u, u) * Dot(v, v);
    if (squared > 1e-6f * sides && squared > 1e-24f && sides < 1e36f) return cross * (1.0f / std::sqrt(squared));
    const Position p = a.cast<double>(), exact = Cross<double>(b.cast<double>() - p, c.cast<double>() - p);
    const double length = std::sqrt(Dot(exact, exact));
    if (!(length > 0)) return Vector3(0, 1, 0);
    return Vector3((exact * (1.0 / length)).cast<float>());
}

}  // namespace fulcrum
