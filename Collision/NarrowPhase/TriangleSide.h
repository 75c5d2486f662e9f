// Position of a point or a shape relative to a triangle of a surface. Used by SurfaceContact alone.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <utility>

namespace fulcrum {

// The back of a two-sided triangle, as a one-sided triangle.
inline TriangleView Reversed(const TriangleView& view) {
    TriangleView r = view;
    std::swap(r.vertices[0], r.vertices[2]);
    std::swap(r.vertexIds[0], r.vertexIds[2]);
    r.normal = -view.normal;
    r.activeEdges =
        static_cast<uint8_t>((view.activeEdges & 4) | (view.activeEdges & 1) << 1 | (view.activeEdges >> 1 & 1));
    return r;
}

// Height of a point above the triangle's plane, m; negative behind it.
inline float HeightAbove(const TriangleView& view, const Vector3& point) {
    return Dot(view.normal, Vector3(point - view.vertices[0]));
}

// Whether the projection of a ball onto the triangle's plane overlaps the triangle.
inline bool IsOver(const TriangleView& view, const Vector3& center, float radius) {
    for (int i = 0; i < 3; ++i) {
        const Vector3 edge = view.vertices[(i + 1) % 3] - view.vertices[i];
        if (Dot(Cross<float>(edge, view.normal), Vector3(center - view.vertices[i])) > radius * Length(edge))
            return false;
    }
    return true;
}

}  // namespace fulcrum
