// Position of a point or a shape relative to a triangle of a surface. Used by SurfaceContact, InternalEdges and shape
// casts.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <algorithm>
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

// A contact normal this close to the face's counts as the face's: a tenth of a degree.
inline constexpr float kFaceCosine = 0.9999985f;

// The corner, or the edge, that a shape touches along an axis towards the triangle (of any length).
struct TriangleFeature {
    int corners[3];  // ascending; those of an edge, or all three
    int count;
    bool isActive;  // whether the edge is, or an edge of the triangle that ends at the corner
};

inline TriangleFeature FeatureAlong(const Vector3 (&vertices)[3], unsigned activeEdges, const Vector3& axis) {
    float along[3], least = 0, most = 0;
    for (int i = 0; i < 3; ++i) {
        along[i] = Dot(axis, Vector3(vertices[i] - vertices[0]));
        least = std::min(least, along[i]);
        most = std::max(most, along[i]);
    }
    const float nearly = least + 1e-3f * (most - least);
    TriangleFeature f{};
    for (int i = 0; i < 3; ++i)
        if (along[i] <= nearly) f.corners[f.count++] = i;
    const auto isActive = [&](int edge) { return (activeEdges >> edge & 1) != 0; };
    const int first = f.corners[0];
    // Corners 0 and 1 are edge 0, 1 and 2 edge 1, 2 and 0 edge 2.
    f.isActive =
        f.count >= 2 ? isActive(f.corners[1] - first == 1 ? first : 2) : isActive(first) || isActive((first + 2) % 3);
    return f;
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
