#include <Fulcrum/UnitTests/Random/RandomShapes.h>

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum::testing {

namespace {

template <class T>
ShapePtr OrNull(const Result<T>& shape) {
    return shape ? ShapePtr(shape.Value()) : nullptr;
}

// What a user derives: an octahedron with edges of three lengths, its mass known.
class Octahedron final : public CustomConvex {
public:
    Octahedron(const Vector3& half, float radius) : CustomConvex(radius), half_(half) {}
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 reach = d.cwiseAbs().cwiseProduct(half_);
        const int axis = reach.x() >= reach.y() ? (reach.x() >= reach.z() ? 0 : 2) : (reach.y() >= reach.z() ? 1 : 2);
        Vector3 corner = Vector3::Zero();
        corner[axis] = d[axis] < 0 ? -half_[axis] : half_[axis];
        return corner;
    }

protected:
    std::optional<SolidMass> KnownMass() const override {
        SolidMass mass;
        const double x = double{half_.x()}, y = double{half_.y()}, z = double{half_.z()};
        mass.volume = 4.0 / 3.0 * x * y * z;
        mass.inertia.xx = mass.volume * (y * y + z * z) / 10;
        mass.inertia.yy = mass.volume * (x * x + z * z) / 10;
        mass.inertia.zz = mass.volume * (x * x + y * y) / 10;
        return mass;
    }

private:
    Vector3 half_;
};

ShapePtr Hull(Values& values) {
    std::vector<Vector3> points;
    const Vector3 half = values.Sizes();
    const uint32_t count = 4 + values.Below(12);
    for (uint32_t i = 0; i < count; ++i) points.push_back(values.Random().InCube().cwiseProduct(half));
    ConvexHullSettings settings;
    if (values.Chance(0.2f)) settings.convexRadius = values.Number(0, 0.05f, true);
    return OrNull(ConvexHull::Create(points, settings));
}

ShapePtr TriangleOf(Values& values) {
    const float size = values.Size();
    const Vector3 a = values.Random().InBox(size), b = values.Random().InBox(size), c = values.Random().InBox(size);
    return OrNull(Triangle::Create(a, b, c, values.Chance(0.5f) ? 0 : values.Number(0, 0.05f, true)));
}

std::vector<CompoundShape::ChildSettings> Children(Values& values) {
    std::vector<CompoundShape::ChildSettings> children;
    const uint32_t count = 1 + values.Below(4);
    for (uint32_t i = 0; i < count; ++i) {
        const ShapePtr shape = RandomConvex(values);
        if (shape) children.push_back({shape, values.Offset(0.6f), values.Rotation(), values.Setting(0.1f, 3)});
    }
    return children;
}

// A wavy floor of 8 by 8 m.
constexpr uint32_t kSide = 9;

ShapePtr Mesh(Values& values) {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    const float scale = values.Chance(0.8f) ? 1.0f : values.Size() * 4;
    for (uint32_t z = 0; z < kSide; ++z)
        for (uint32_t x = 0; x < kSide; ++x) {
            const float y = values.Number(0, 0.5f, values.Style().extremePlaces && values.Chance(0.1f));
            vertices.push_back(Vector3(static_cast<float>(x) - 4, y, static_cast<float>(z) - 4) * scale);
        }
    for (uint32_t z = 0; z + 1 < kSide; ++z)
        for (uint32_t x = 0; x + 1 < kSide; ++x) {
            const uint32_t a = z * kSide + x;
            for (const uint32_t index : {a, a + kSide, a + 1, a + 1, a + kSide, a + kSide + 1})
                indices.push_back(index);
        }
    return OrNull(TriangleMesh::Create({.vertices = vertices, .indices = indices, .isTwoSided = values.Chance(0.5f)}));
}

ShapePtr Heights(Values& values) {
    std::vector<float> heights;
    for (uint32_t i = 0; i < kSide * kSide; ++i)
        heights.push_back(values.Number(0, 0.5f, values.Style().extremePlaces && values.Chance(0.1f)));
    HeightFieldSettings settings{.sampleCountX = kSide, .sampleCountZ = kSide, .heights = heights};
    settings.origin = Vector3(-4, 0, -4);
    if (values.Chance(0.2f)) settings.cellSizeX = values.Size() * 2;
    settings.isTwoSided = values.Chance(0.3f);
    if (values.Chance(0.3f)) settings.precision = HeightPrecision::Steps16;
    return OrNull(HeightField::Create(settings));
}

ShapePtr Changed(Values& values, const ShapePtr& shape) {
    if (!shape) return nullptr;
    const float s = values.Size() * 3;
    switch (values.Below(3)) {
        case 0: return OrNull(Scaled(shape, Vector3(s, s, s)));
        case 1: {
            const Quaternion rotation = values.Rotation();
            return OrNull(RotatedTranslated(shape, values.Offset(0.5f), rotation));
        }
        default: return OrNull(OffsetCenterOfMass(shape, values.Offset(0.1f)));
    }
}

}  // namespace

ShapePtr RandomConvex(Values& values) {
    switch (values.Below(9)) {
        case 0: return OrNull(Sphere::Create(values.Size()));
        case 1: {
            const float radius = values.Size();
            return OrNull(Capsule::Create(values.Size(), radius));
        }
        case 2: return Hull(values);
        case 3: return TriangleOf(values);
        case 4: {
            const float bottom = values.Size(), top = values.Size();
            return OrNull(TaperedCapsule::Create(values.Size(), top, bottom));
        }
        case 5: {
            const float bottom = values.Size(), top = values.Size();
            return OrNull(Cylinder::CreateTapered(values.Size(), top, bottom));
        }
        case 6: {
            const float rounding = values.Chance(0.5f) ? 0 : values.Number(0, 0.05f, true);
            return OrNull(CreateCustom<Octahedron>(values.Sizes(), rounding));
        }
        default: {
            const float rounding = values.Chance(0.8f) ? 0 : values.Number(0, 0.05f, true);
            return OrNull(Box::Create(values.Sizes(), rounding));
        }
    }
}

ShapePtr RandomSolid(Values& values) {
    if (values.Chance(0.7f)) return RandomConvex(values);
    if (values.Chance(0.3f)) return Changed(values, RandomConvex(values));
    const std::vector<CompoundShape::ChildSettings> children = Children(values);
    return values.Chance(0.5f) ? OrNull(Compound::Create(children)) : OrNull(MutableCompound::Create(children));
}

ShapePtr RandomShape(Values& values) {
    switch (values.Below(10)) {
        case 0: return Mesh(values);
        case 1: return Heights(values);
        case 2: {
            const float offset = values.Number(-1, 1, true);
            return OrNull(Plane::Create(values.Offset(1), offset));
        }
        case 3: return EmptyShape::Create();
        default: return RandomSolid(values);
    }
}

}  // namespace fulcrum::testing
