// Convex hull of points as a mesh of convex polygons, within limits on its size. Called by ConvexHull. Serial, pure.
// Quickhull gives triangles; here those that are coplanar within the tolerance become polygons.
#pragma once

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Quickhull.h>

namespace fulcrum {

struct HullMesh {
    struct Face {
        PolygonRange corners;
        Position normal;  // unit, outwards
        double offset;    // normal . x <= offset for all vertices
    };
    std::vector<Position> vertices;
    std::vector<int> sources;  // the input point that each vertex is
    std::vector<Face> faces;
    std::vector<int> indices;  // into vertices
    double tolerance = 0;      // m: corners lie within this of their face's plane

    SolidMass Mass() const;
};

struct HullLimits {
    int maxVertices = 255;
    int maxFaces = 255;
    double inputRounding = 0x1p-24;  // relative error of the input's coordinates: float
};

// The hull of `points` (finite). Every edge belongs to two faces, every vertex to three or more, and two faces share at
// most one edge. If the limits were not reached, no point is farther outside a face than 3 times the mesh's tolerance,
// which is that of Quickhull. If they were, the vertices are those that Quickhull found first, the farthest ones; the
// hull is then inside the exact one. Error: Degenerate.
Result<HullMesh> BuildHull(std::span<const Position> points, const HullLimits& limits = {});

// Whether the mesh is a closed polyhedron as BuildHull guarantees: edges in pairs, vertex degrees, Euler's V - E + F =
// 2.
bool IsClosedPolyhedron(const HullMesh& mesh);

}  // namespace fulcrum
