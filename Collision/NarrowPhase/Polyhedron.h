// One view of the cores of all convex shapes: a hull, a box, a capsule's segment and a sphere's point are polyhedra of
// many, 8, 2 and 1 vertices. The pair functions of polyhedra work on it. Used by the narrow phase alone; a view lives
// on the stack of one call.
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
    int faceCount;  // 0: a segment or a point
    const Vector3* vertices;
    const ConvexHull::Face* faces;
    const uint8_t* indices;
    const ConvexHull::Edge* edges;
    int edgeCount;
    float radius;       // m: the shape is the polyhedron rounded by it
    float innerRadius;  // m: the ball about the origin of this radius lies inside the core
};

// Where the view of a shape that is not a hull keeps its numbers.
struct PolyhedronStorage {
    alignas(32) float lanes[24];
    Vector3 vertices[8];
    ConvexHull::Face faces[6];
};

Polyhedron CoreOf(const ConvexHull& hull);
// Vertex i lies at the positive x, y, z side where bit 0, 1, 2 of i is set. Faces: +x, -x, +y, -y, +z, -z.
Polyhedron CoreOf(const class Box& box, PolyhedronStorage& storage);
Polyhedron CoreOf(const class Capsule& capsule, PolyhedronStorage& storage);
Polyhedron CoreOf(const class Sphere& sphere, PolyhedronStorage& storage);
// Any of those.
Polyhedron CoreOf(const ConvexShape& shape, PolyhedronStorage& storage);

struct Extreme {
    int vertex;
    float value;  // direction . vertex
};

// The vertex that lies farthest along `direction`; of several, the first. The search runs eight vertices at a time.
inline Extreme FarthestVertex(const Polyhedron& p, const Vector3& direction) {
    constexpr int kMaxBlocks = 256 / 8;
    const Wide<8> dx(direction.x()), dy(direction.y()), dz(direction.z());
    const auto blockValue = [&](int i) {
        return dx * Wide<8>::Load(p.x + i) + dy * Wide<8>::Load(p.y + i) + dz * Wide<8>::Load(p.z + i);
    };
    Wide<8> values[kMaxBlocks];
    Wide<8> largest = values[0] = blockValue(0);
    const int blocks = p.laneCount / 8;
    for (int k = 1; k < blocks; ++k) {
        values[k] = blockValue(8 * k);
        largest = Max(largest, values[k]);
    }
    const float value = Largest(largest);
    const Wide<8> wanted(value);
    return {FirstWhere(values, blocks, [&](Wide<8> v) { return v == wanted; }), value};
}

// How many vertices lie at least as far along `direction` as `threshold`.
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

// The face whose normal points most nearly along `direction`. Only where the polyhedron has faces.
inline int FaceAlong(const Polyhedron& p, const Vector3& direction) {
    int best = 0;
    float bestCosine = Dot(p.faces[0].normal, direction);
    for (int i = 1; i < p.faceCount; ++i) {
        const float cosine = Dot(p.faces[i].normal, direction);
        if (cosine > bestCosine) {
            bestCosine = cosine;
            best = i;
        }
    }
    return best;
}

}  // namespace fulcrum
