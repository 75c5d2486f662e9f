#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

namespace fulcrum {

namespace {

// Four corners a face, counter-clockwise seen from outside.
constexpr uint8_t kBoxIndices[24] = {1, 3, 7, 5, 0, 4, 6, 2, 2, 6, 7, 3, 0, 1, 5, 4, 4, 5, 7, 6, 0, 2, 3, 1};

// The six normals in lanes, padded with the first.
alignas(32) constexpr float kBoxNormals[24] = {1, -1, 0, 0, 0, 0, 1, 1, 0, 0,  1, -1,
                                               0, 0,  0, 0, 0, 0, 0, 0, 1, -1, 0, 0};

// From, to, the face on the left (seen from outside, upwards along the edge) and on the right.
constexpr ConvexHull::Edge kBoxEdges[12] = {{0, 1, 5, 3}, {2, 3, 2, 5}, {4, 5, 3, 4}, {6, 7, 4, 2},
                                            {0, 2, 1, 5}, {1, 3, 5, 0}, {4, 6, 4, 1}, {5, 7, 0, 4},
                                            {0, 4, 3, 1}, {1, 5, 0, 3}, {2, 6, 1, 2}, {3, 7, 2, 0}};
constexpr uint8_t kTriangleIndices[6] = {0, 1, 2, 2, 1, 0};
constexpr ConvexHull::Edge kTriangleEdges[3] = {{0, 1, 0, 1}, {1, 2, 0, 1}, {2, 0, 0, 1}};
// A segment has no faces; the indices of faces are not used.
constexpr ConvexHull::Edge kSegmentEdge[1] = {{0, 1, 0, 0}};

Polyhedron SmallCore(const PolyhedronStorage& storage, int vertexCount, int faceCount) {
    Polyhedron p;
    p.x = storage.lanes;
    p.y = storage.lanes + 8;
    p.z = storage.lanes + 16;
    p.laneCount = 8;
    p.vertexCount = vertexCount;
    p.normalX = kBoxNormals;
    p.normalY = kBoxNormals + 8;
    p.normalZ = kBoxNormals + 16;
    p.faceLaneCount = 8;
    p.faceCount = faceCount;
    p.vertices = storage.vertices;
    p.faces = storage.faces;
    p.indices = kBoxIndices;
    p.edges = faceCount > 0 ? kBoxEdges : kSegmentEdge;
    p.edgeCount = faceCount > 0 ? 12 : vertexCount - 1;
    p.radius = 0;
    p.innerRadius = p.size = 0;
    return p;
}

void FillLanes(PolyhedronStorage& storage, int vertexCount) {
    for (int i = 0; i < 8; ++i) {
        const Vector3& v = storage.vertices[i < vertexCount ? i : 0];
        storage.lanes[i] = v.x();
        storage.lanes[8 + i] = v.y();
        storage.lanes[16 + i] = v.z();
    }
}

}  // namespace

Polyhedron CoreOf(const ConvexHull& hull) {
    Polyhedron p;
    p.x = hull.LaneX();
    p.y = hull.LaneY();
    p.z = hull.LaneZ();
    p.laneCount = hull.PaddedVertexCount();
    p.vertexCount = static_cast<int>(hull.vertices_.size());
    p.normalX = hull.NormalLaneX();
    p.normalY = hull.NormalLaneY();
    p.normalZ = hull.NormalLaneZ();
    p.faceLaneCount = hull.PaddedFaceCount();
    p.faceCount = static_cast<int>(hull.faces_.size());
    p.vertices = hull.vertices_.data();
    p.faces = hull.faces_.data();
    p.indices = hull.indices_.data();
    p.edges = hull.edges_.data();
    p.edgeCount = static_cast<int>(hull.edges_.size());
    p.radius = hull.ConvexRadius();
    p.innerRadius = p.size = Max(0.0f, hull.InnerRadius() - hull.ConvexRadius());
    return p;
}

Polyhedron CoreOf(const Box& box, PolyhedronStorage& storage) {
    const float radius = box.ConvexRadius();
    const Vector3 h = box.HalfExtents() - Vector3::Constant(radius);
    for (int i = 0; i < 8; ++i)
        storage.vertices[i] = Vector3(i & 1 ? h.x() : -h.x(), i & 2 ? h.y() : -h.y(), i & 4 ? h.z() : -h.z());
    for (int i = 0; i < 6; ++i) {
        ConvexHull::Face& face = storage.faces[i];
        face.firstIndex = static_cast<uint16_t>(4 * i);
        face.cornerCount = 4;
        face.normal = Vector3::Zero();
        face.normal[i / 2] = i % 2 == 0 ? 1.0f : -1.0f;
        face.offset = h[i / 2];
    }
    FillLanes(storage, 8);
    Polyhedron p = SmallCore(storage, 8, 6);
    p.radius = radius;
    p.innerRadius = p.size = Min(h.x(), Min(h.y(), h.z()));
    return p;
}

Polyhedron CoreOf(const Vector3 (&corners)[3], const Vector3& n, float radius, PolyhedronStorage& storage) {
    for (int i = 0; i < 3; ++i) storage.vertices[i] = corners[i];
    for (int i = 0; i < 2; ++i) {
        ConvexHull::Face& face = storage.faces[i];
        face.firstIndex = static_cast<uint16_t>(3 * i);
        face.cornerCount = 3;
        face.normal = i == 0 ? n : Vector3(-n);
        face.offset = Dot(face.normal, storage.vertices[0]);
    }
    for (int i = 0; i < 8; ++i) {
        const Vector3& normal = storage.faces[i == 1 ? 1 : 0].normal;
        storage.normalLanes[i] = normal.x();
        storage.normalLanes[8 + i] = normal.y();
        storage.normalLanes[16 + i] = normal.z();
    }
    FillLanes(storage, 3);
    Polyhedron p = SmallCore(storage, 3, 2);
    p.normalX = storage.normalLanes;
    p.normalY = storage.normalLanes + 8;
    p.normalZ = storage.normalLanes + 16;
    p.indices = kTriangleIndices;
    p.edges = kTriangleEdges;
    p.edgeCount = 3;
    p.radius = radius;
    // The smallest distance of a corner from the centroid.
    p.size = Sqrt(Min(LengthSquared(corners[0]), Min(LengthSquared(corners[1]), LengthSquared(corners[2]))));
    return p;
}

Polyhedron CoreOf(const Triangle& triangle, PolyhedronStorage& storage) {
    const Vector3 corners[3] = {triangle.Corner(0), triangle.Corner(1), triangle.Corner(2)};
    return CoreOf(corners, triangle.Normal(), triangle.ConvexRadius(), storage);
}

Polyhedron CoreOf(const Capsule& capsule, PolyhedronStorage& storage) {
    storage.vertices[0] = Vector3(0, -capsule.HalfHeight(), 0);
    storage.vertices[1] = Vector3(0, capsule.HalfHeight(), 0);
    FillLanes(storage, 2);
    Polyhedron p = SmallCore(storage, 2, 0);
    p.radius = capsule.Radius();
    return p;
}

// Of a sphere, or of a point that queries search for.
Polyhedron PointWithRadius(float radius, PolyhedronStorage& storage) {
    storage.vertices[0] = Vector3::Zero();
    FillLanes(storage, 1);
    Polyhedron p = SmallCore(storage, 1, 0);
    p.radius = radius;
    return p;
}

Polyhedron CoreOf(const ConvexShape& shape, PolyhedronStorage& storage) {
    switch (shape.Type()) {
        case ShapeType::Sphere: return PointWithRadius(shape.ConvexRadius(), storage);
        case ShapeType::Box: return CoreOf(static_cast<const Box&>(shape), storage);
        case ShapeType::Capsule: return CoreOf(static_cast<const Capsule&>(shape), storage);
        case ShapeType::ConvexHull: return CoreOf(static_cast<const ConvexHull&>(shape));
        case ShapeType::Triangle: return CoreOf(static_cast<const Triangle&>(shape), storage);
        case ShapeType::TaperedCapsule:
        case ShapeType::Cylinder:
        case ShapeType::Custom:
        case ShapeType::Compound:
        case ShapeType::MutableCompound:
        case ShapeType::TriangleMesh:
        case ShapeType::HeightField:
        case ShapeType::Plane:
        case ShapeType::Empty: break;
    }
    FULCRUM_ASSERT(false && "the shape has no polyhedral core");
    return {};
}

}  // namespace fulcrum
