#include <Fulcrum/Collision/Shapes/Shape.h>

#include <atomic>

namespace fulcrum {

namespace {

std::atomic<uint64_t> latestVersion{0};

}  // namespace

uint64_t LatestShapeVersion() { return latestVersion.load(std::memory_order_acquire); }

void Shape::NoteEdit() {
    version_ = latestVersion.fetch_add(1, std::memory_order_acq_rel) + 1;
    hash_.Forget();
}

const char* ShapeTypeName(ShapeType type) {
    switch (type) {
        case ShapeType::Sphere: return "sphere";
        case ShapeType::Box: return "box";
        case ShapeType::Capsule: return "capsule";
        case ShapeType::ConvexHull: return "convex hull";
        case ShapeType::Triangle: return "triangle";
        case ShapeType::TaperedCapsule: return "tapered capsule";
        case ShapeType::Cylinder: return "cylinder";
        case ShapeType::Custom: return "custom shape";
        case ShapeType::Compound: return "compound";
        case ShapeType::MutableCompound: return "mutable compound";
        case ShapeType::TriangleMesh: return "triangle mesh";
        case ShapeType::HeightField: return "height field";
        case ShapeType::Plane: return "plane";
        case ShapeType::Empty: return "empty shape";
    }
    return "unknown";
}

}  // namespace fulcrum
