#include <Fulcrum/Samples/Runner/RecordedShapes.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/SampledSurface.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <map>
#include <tuple>

namespace fulcrum {
namespace {

RecordedShape RecordedHull(const ConvexHull& hull) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    // The recording uses the shape's own frame, the hull its center frame.
    for (const Vector3& vertex : hull.Vertices()) shape.vertices.push_back(vertex + hull.Mass().centerOfMass);
    for (const ConvexHull::Face& face : hull.Faces()) {
        const auto corners = hull.Indices().subspan(face.firstIndex, face.cornerCount);
        for (size_t i = 2; i < corners.size(); ++i) shape.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
    return shape;
}

// Other convex shapes, as a mesh from the support function: points every 4 degrees on a cylinder's rim.
RecordedShape RecordedConvex(const ConvexShape& source) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(source.Type());
    const SampledSurface surface = SampleSurface(source, 16);
    std::map<std::tuple<float, float, float>, uint32_t> known;  // many directions share a corner
    std::vector<uint32_t> indices;
    for (const Vector3& v : surface.vertices) {
        const auto [at, isNew] =
            known.emplace(std::tuple(v.x(), v.y(), v.z()), static_cast<uint32_t>(shape.vertices.size()));
        if (isNew) shape.vertices.push_back(v + source.Mass().centerOfMass);
        indices.push_back(at->second);
    }
    for (size_t i = 0; i < surface.indices.size(); i += 3) {
        const auto corner = [&](size_t k) { return indices[static_cast<size_t>(surface.indices[i + k])]; };
        if (corner(0) != corner(1) && corner(1) != corner(2) && corner(0) != corner(2))
            shape.triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return shape;
}

RecordedShape RecordedTriangles(const SurfaceShape& source) {
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(source.Type());
    std::map<uint32_t, uint32_t> known;
    source.VisitTriangles(source.LocalBounds(), [&](uint32_t id) {
        const TriangleView view = source.GetTriangle(id);
        std::array<uint32_t, 3> corners;
        if (!source.Materials().empty()) shape.looks.push_back(view.material);
        for (size_t i = 0; i < 3; ++i) {
            const auto [at, isNew] = known.emplace(view.vertexIds[i], static_cast<uint32_t>(shape.vertices.size()));
            if (isNew) shape.vertices.push_back(view.vertices[i]);
            corners[i] = at->second;
        }
        shape.triangles.push_back(corners);
    });
    return shape;
}

// A square of it around the point nearest to its origin.
RecordedShape RecordedPlane(const Plane& plane) {
    constexpr float kHalf = 100;  // m
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    shape.name = ShapeTypeName(plane.Type());
    const Vector3 center = plane.Normal() * plane.Offset(), u = Perpendicular(plane.Normal()) * kHalf,
                  v = Cross<float>(plane.Normal(), u);
    shape.vertices = {center - u - v, center + u - v, center + u + v, center - u + v};
    shape.triangles = {{0, 1, 2}, {0, 2, 3}};
    return shape;
}

}  // namespace

RecordedShape RecordedShapeOf(const Shape& source) {
    RecordedShape shape;
    if (const auto* sphere = dynamic_cast<const Sphere*>(&source)) {
        shape.kind = RecordedShapeKind::Sphere;
        shape.radius = sphere->Radius();
    } else if (const auto* box = dynamic_cast<const Box*>(&source)) {
        shape.kind = RecordedShapeKind::Box;
        shape.halfExtents = box->HalfExtents();
    } else if (const auto* capsule = dynamic_cast<const Capsule*>(&source)) {
        shape.kind = RecordedShapeKind::Capsule;
        shape.radius = capsule->Radius();
        shape.halfHeight = capsule->HalfHeight();
    } else if (const auto* hull = dynamic_cast<const ConvexHull*>(&source)) {
        return RecordedHull(*hull);
    } else if (const auto* convex = dynamic_cast<const ConvexShape*>(&source)) {
        return RecordedConvex(*convex);
    } else if (const auto* surface = dynamic_cast<const SurfaceShape*>(&source)) {
        return RecordedTriangles(*surface);
    } else if (const auto* plane = dynamic_cast<const Plane*>(&source)) {
        return RecordedPlane(*plane);
    } else {
        shape.kind = RecordedShapeKind::Compound;  // of nothing
    }
    return shape;
}

RecordedMotion RecordedMotionOf(MotionType motion) {
    switch (motion) {
        case MotionType::Static: return RecordedMotion::Static;
        case MotionType::Kinematic: return RecordedMotion::Kinematic;
        default: return RecordedMotion::Dynamic;
    }
}

}  // namespace fulcrum
