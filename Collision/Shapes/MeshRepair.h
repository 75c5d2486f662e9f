// Checks and repairs the triangles of a mesh before it is built. Called by TriangleMesh::Create. Serial, pure.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Math/Vector.h>

#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum {

// The number of repairs of a kind, and the first one (an index of the input).
struct MeshFinding {
    uint32_t count = 0;
    uint32_t first = 0;
    void Add(uint32_t id) {
        if (count++ == 0) first = id;
    }
};

struct MeshReport {
    MeshFinding weldedVertices;       // merged with an earlier vertex
    MeshFinding unusedVertices;       // dropped: no remaining triangle uses them
    MeshFinding degenerateTriangles;  // dropped: no area
    MeshFinding duplicateTriangles;   // dropped: the same vertices and orientation as an earlier one
    uint32_t boundaryEdges = 0;       // edges of one triangle: where the surface ends
    uint32_t irregularEdges = 0;      // of more than two triangles, or of two with opposite orientation
    bool IsClean() const {
        return weldedVertices.count == 0 && unusedVertices.count == 0 && degenerateTriangles.count == 0 &&
               duplicateTriangles.count == 0;
    }
};

struct RepairedMesh {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;  // three per triangle
    std::vector<uint32_t> sources;  // the input's number of each triangle
};

// Whether a triangle is higher than `weldDistance` m and 1e-6 of its longest edge.
bool HasArea(const Vector3& a, const Vector3& b, const Vector3& c, double weldDistance);

// Vertices within `weldDistance` m of an earlier one become that one. A triangle has no area if its height is below
// `weldDistance` or 1e-6 of its longest edge.
// Errors: NonFinite, OutOfRange (an index), Degenerate (nothing left, or a number of indices that is no multiple of
// three).
Result<RepairedMesh> RepairMesh(std::span<const Vector3> vertices, std::span<const uint32_t> indices,
                                float weldDistance, MeshReport& report);

}  // namespace fulcrum
