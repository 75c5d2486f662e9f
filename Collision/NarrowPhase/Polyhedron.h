// A uniform view of polyhedral cores: a hull, a box, a triangle, a capsule's segment and a sphere's point are polyhedra
// of many, 8, 3, 2 and 1 vertices. Used by the narrow phase alone; a view lives on the stack of one call.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/LaneSearch.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>

namespace fulcrum {

struct Polyhedron {
    const float* x;  // the vertices by lanes: laneCount floats each, a multiple of 8, padded with vertex 0
    const float* y;
    const float* z;
    int laneCount;
    int vertexCount;
    const float* normalX;  // the faces' normals in the same way
    const float* normalY;
    const float* normalZ;
    int faceLaneCount;
    int faceCount;  // 0: a segment or a point
    const Vector3* vertices;
    const ConvexHull::Face* faces;
    const uint8_t* indices;
    const ConvexHull::Edge* edges;
    int edgeCount;
    float radius;       // m: the shape is the polyhedron rounded by it
    float innerRadius;  // m: the ball about the origin of this radius lies inside the core
    float size;         // m: the scale of its tolerances; the inner radius if that is not 0
};

// Storage for views of shapes that are not hulls.
struct PolyhedronStorage {
    alignas(32) float lanes[24];
    alignas(32) float normalLanes[24];  // if the faces are not aligned with the axes
    Vector3 vertices[8];
    ConvexHull::Face faces[6];
};

inline bool HasPolyhedralCore(ShapeType type) {
    return type <= ShapeType::Triangle;  // and all enumerators before it
}

Polyhedron CoreOf(const ConvexHull& hull);
// Vertex i lies at the positive x, y, z side where bit 0, 1, 2 of i is set. Faces: +x, -x, +y, -y, +z, -z.
Polyhedron CoreOf(const class Box& box, PolyhedronStorage& storage);
// Two faces back to back; face 0 has the given normal. The corners are about their centroid, m.
Polyhedron CoreOf(const Vector3 (&corners)[3], const Vector3& normal, float radius, PolyhedronStorage& storage);
Polyhedron CoreOf(const class Triangle& triangle, PolyhedronStorage& storage);
Polyhedron CoreOf(const class Capsule& capsule, PolyhedronStorage& storage);
Polyhedron CoreOf(const class Sphere& sphere, PolyhedronStorage& storage);
// Any of those; only if HasPolyhedralCore(shape.Type()).
Polyhedron CoreOf(const ConvexShape& shape, PolyhedronStorage& storage);

inline Extreme FarthestVertex(const Polyhedron& p, const Vector3& direction) {
    return Farthest(p.x, p.y, p.z, p.laneCount, direction);
}

// The number of vertices at least as far along `direction` as `threshold`.
inline int CountBeyond(const Polyhedron& p, const Vector3& direction, float threshold) {
    const Wide<8> dx(direction.x()), dy(direction.y()), dz(direction.z()), wanted(threshold);
    int count = 0;
    for (int i = 0; i < p.laneCount; i += 8) {
        const Wide<8> value = dx * Wide<8>::Load(p.x + i) + dy * Wide<8>::Load(p.y + i) + dz * Wide<8>::Load(p.z + i);
        uint32_t hits = (value >= wanted).ToBits();
        const int left = p.vertexCount - i;
        if (left < 8) hits &= left <= 0 ? 0u : (1u << left) - 1u;
        count += __builtin_popcount(hits);
    }
    return count;
}

// The face whose normal points most nearly along `direction`. The polyhedron must have faces.
inline int FaceAlong(const Polyhedron& p, const Vector3& direction) {
    return Farthest(p.normalX, p.normalY, p.normalZ, p.faceLaneCount, direction).index;
}

}  // namespace fulcrum
