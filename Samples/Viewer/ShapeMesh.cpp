#include <Fulcrum/Samples/Viewer/ShapeMesh.h>

#include <cmath>
#include <numbers>

namespace fulcrum {
namespace {

constexpr int kAround = 24;  // sides of a round body
constexpr int kDown = 6;     // rings of a half sphere

void AddTriangle(ShapeMesh& mesh, const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 normal = Normalized(Vector3(Cross<float>(b - a, c - a)));
    for (const Vector3& corner : {a, b, c}) {
        mesh.indices.push_back(static_cast<uint32_t>(mesh.positions.size()));
        mesh.positions.push_back(corner);
        mesh.normals.push_back(normal);
    }
}

void AddBox(ShapeMesh& mesh, const Vector3& half) {
    for (int axis = 0; axis < 3; ++axis) {
        for (float side : {-1.0f, 1.0f}) {
            Vector3 normal = Vector3::Zero(), u = normal, v = normal;
            normal[axis] = side;
            u[(axis + 1) % 3] = 1;
            v[(axis + 2) % 3] = side;  // u x v = normal
            const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
            for (const Vector3& corner :
                 {Vector3(normal - u - v), Vector3(normal + u - v), Vector3(normal + u + v), Vector3(normal - u + v)}) {
                mesh.positions.push_back(corner.cwiseProduct(half));
                mesh.normals.push_back(normal);
            }
            for (uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + corner);
        }
    }
}

// Rings from the upper pole to the lower, the two half spheres drawn apart by the segment of a capsule; a sphere has
// none.
void AddRound(ShapeMesh& mesh, float radius, float halfHeight) {
    const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
    const int rings = 2 * (kDown + 1);
    for (int ring = 0; ring < rings; ++ring) {
        const bool isUpper = ring <= kDown;
        const double polar = std::numbers::pi / (2 * kDown) * (isUpper ? ring : ring - 1);
        for (int side = 0; side <= kAround; ++side) {
            const double angle = 2 * std::numbers::pi / kAround * side;
            const Vector3 normal(static_cast<float>(std::sin(polar) * std::cos(angle)),
                                 static_cast<float>(std::cos(polar)),
                                 static_cast<float>(std::sin(polar) * std::sin(angle)));
            mesh.normals.push_back(Normalized(normal));
            mesh.positions.push_back(normal * radius + Vector3(0, isUpper ? halfHeight : -halfHeight, 0));
        }
    }
    for (int ring = 0; ring + 1 < rings; ++ring) {
        if (ring == kDown && halfHeight == 0) continue;
        for (int side = 0; side < kAround; ++side) {
            const uint32_t a = first + static_cast<uint32_t>(ring * (kAround + 1) + side), b = a + kAround + 1;
            // At the poles one of the two triangles has no area.
            if (ring > 0) mesh.indices.insert(mesh.indices.end(), {a, a + 1, b + 1});
            if (ring + 2 < rings) mesh.indices.insert(mesh.indices.end(), {a, b + 1, b});
        }
    }
}

void AddChild(ShapeMesh& mesh, const ShapeMesh& child, const RelativePose& pose) {
    const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vector3& position : child.positions) mesh.positions.push_back(pose.Transform(position));
    for (const Vector3& normal : child.normals)
        mesh.normals.push_back(Normalized(Vector3(Rotate(pose.rotation, normal))));
    for (uint32_t index : child.indices) mesh.indices.push_back(first + index);
}

}  // namespace

ShapeMesh MeshOfShape(const Recording& recording, size_t index) {
    const RecordedShape& shape = recording.shapes[index];
    ShapeMesh mesh;
    switch (shape.kind) {
        case RecordedShapeKind::Sphere: AddRound(mesh, shape.radius, 0); break;
        case RecordedShapeKind::Capsule: AddRound(mesh, shape.radius, shape.halfHeight); break;
        case RecordedShapeKind::Box: AddBox(mesh, shape.halfExtents); break;
        case RecordedShapeKind::Hull:
            for (const auto& t : shape.triangles)
                AddTriangle(mesh, shape.vertices[t[0]], shape.vertices[t[1]], shape.vertices[t[2]]);
            break;
        case RecordedShapeKind::Compound:
            for (const RecordedChild& child : shape.children)
                AddChild(mesh, MeshOfShape(recording, child.shape), child.pose);
            break;
    }
    return mesh;
}

bool IsEmptyShape(const Recording& recording, size_t index) {
    const RecordedShape& shape = recording.shapes[index];
    if (shape.kind == RecordedShapeKind::Hull) return shape.triangles.empty();
    if (shape.kind != RecordedShapeKind::Compound) return false;
    for (const RecordedChild& child : shape.children)
        if (!IsEmptyShape(recording, child.shape)) return false;
    return true;
}

}  // namespace fulcrum
