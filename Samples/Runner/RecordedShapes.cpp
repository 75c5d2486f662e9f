#include <Fulcrum/Samples/Runner/RecordedShapes.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Physics/Drawing/ShapeTriangles.h>

#include <map>
#include <tuple>

namespace fulcrum {
namespace {

// The triangles that a DrawingTarget gets, with shared corners; of a surface with its materials as looks.
RecordedShape RecordedTriangles(const Shape& source) {
    constexpr int kDetail = 4;         // round shapes have 2048
    constexpr float kHalfPlane = 100;  // m
    RecordedShape shape;
    shape.kind = RecordedShapeKind::Hull;
    if (source.Type() != ShapeType::ConvexHull) shape.name = ShapeTypeName(source.Type());
    const bool hasLooks = source.IsSurface() && !static_cast<const SurfaceShape&>(source).Materials().empty();
    std::map<std::tuple<float, float, float>, uint32_t> known;
    VisitTriangles(
        source,
        [&](const DrawnTriangle& triangle) {
            std::array<uint32_t, 3> corners;
            for (size_t i = 0; i < 3; ++i) {
                const Vector3& at = triangle.corners[i];
                const auto [place, isNew] =
                    known.emplace(std::tuple(at.x(), at.y(), at.z()), static_cast<uint32_t>(shape.vertices.size()));
                if (isNew) shape.vertices.push_back(at);
                corners[i] = place->second;
            }
            shape.triangles.push_back(corners);
            if (hasLooks) shape.looks.push_back(triangle.material);
        },
        kDetail, kHalfPlane);
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
    } else if (source.IsConvex() || source.IsSurface() || source.Type() == ShapeType::Plane) {
        return RecordedTriangles(source);
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
