#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

const char* ShapeTypeName(ShapeType type) {
    switch (type) {
        case ShapeType::Sphere: return "sphere";
        case ShapeType::Box: return "box";
        case ShapeType::Capsule: return "capsule";
        case ShapeType::ConvexHull: return "convex hull";
        case ShapeType::Compound: return "compound";
    }
    return "unknown";
}

}  // namespace fulcrum
