#include <Fulcrum/Collision/Shapes/Scaled.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Matrix.h>

#include <cmath>

namespace fulcrum {
namespace {

// Factors this close count as equal, relative: those of a product of floats.
constexpr float kSame = 1e-5f;

bool Same(float a, float b) { return std::fabs(a - b) <= kSame * std::fmax(std::fabs(a), std::fabs(b)); }

bool IsUniform(const Vector3& size) { return Same(size.x(), size.y()) && Same(size.x(), size.z()); }

Error NotThat(const Shape& shape, const Vector3& scale, const Vector3& nearest) {
    return {ErrorCode::Unsupported,
            Message("a %s cannot be scaled by (%g, %g, %g); the nearest that it can is (%g, %g, %g)",
                    ShapeTypeName(shape.Type()), double{scale.x()}, double{scale.y()}, double{scale.z()},
                    double{nearest.x()}, double{nearest.y()}, double{nearest.z()})};
}

// With the signs of `scale`, all of the mean size.
Vector3 NearestUniform(const Vector3& scale) {
    const float mean = (std::fabs(scale.x()) + std::fabs(scale.y()) + std::fabs(scale.z())) / 3;
    return Vector3(std::copysign(mean, scale.x()), std::copysign(mean, scale.y()), std::copysign(mean, scale.z()));
}

template <class T>
Result<ShapePtr> AsShape(const Result<T>& result) {
    if (!result) return result.GetError();
    return ShapePtr(result.Value());
}

Result<ShapePtr> ScaledHull(const ConvexHull& hull, const Vector3& scale) {
    if (hull.ConvexRadius() > 0) {
        return Error{ErrorCode::Unsupported,
                     "a hull with a convex radius cannot be scaled: make one of the scaled points"};
    }
    std::vector<Vector3> points;
    for (const Vector3& v : hull.Vertices())
        points.push_back(Vector3(v + hull.Mass().centerOfMass).cwiseProduct(scale));
    return AsShape(ConvexHull::Create(points, {.maxVertices = 255}));
}

Result<ShapePtr> ScaledTriangle(const Triangle& triangle, const Vector3& scale, const Vector3& size) {
    if (triangle.ConvexRadius() > 0 && !IsUniform(size)) return NotThat(triangle, scale, NearestUniform(scale));
    const Vector3 center = triangle.Mass().centerOfMass;
    const auto corner = [&](int i) { return Vector3(Vector3(triangle.Corner(i) + center).cwiseProduct(scale)); };
    return AsShape(Triangle::Create(corner(0), corner(1), corner(2), triangle.ConvexRadius() * size.minCoeff()));
}

Result<ShapePtr> ScaledCylinder(const Cylinder& cylinder, const Vector3& scale, const Vector3& size) {
    if (!Same(size.x(), size.z())) {
        const float across = (size.x() + size.z()) / 2;
        return NotThat(cylinder, scale,
                       Vector3(std::copysign(across, scale.x()), scale.y(), std::copysign(across, scale.z())));
    }
    const float top = cylinder.TopRadius() * size.x(), bottom = cylinder.BottomRadius() * size.x();
    const bool upsideDown = scale.y() < 0;
    return AsShape(Cylinder::CreateTapered(cylinder.HalfHeight() * size.y(), upsideDown ? bottom : top,
                                           upsideDown ? top : bottom, cylinder.ConvexRadius() * size.minCoeff()));
}

// The integral of x x^T, from which inertia comes as trace(C) 1 - C, scales with S C S and the volume.
SolidMass ScaledMass(const SolidMass& solid, const Position& s) {
    const double volume = std::fabs(s.x() * s.y() * s.z());
    const Sym3<double>& i = solid.inertia;
    const double half = (i.xx + i.yy + i.zz) / 2;
    const double xx = (half - i.xx) * s.x() * s.x() * volume, yy = (half - i.yy) * s.y() * s.y() * volume,
                 zz = (half - i.zz) * s.z() * s.z() * volume;
    SolidMass result;
    result.volume = solid.volume * volume;
    result.center = solid.center.cwiseProduct(s);
    result.inertia = {yy + zz,
                      xx + zz,
                      xx + yy,
                      i.xy * s.x() * s.y() * volume,
                      i.xz * s.x() * s.z() * volume,
                      i.yz * s.y() * s.z() * volume};
    return result;
}

// A user's shape through a scale: the farthest point along d of the image is the image of the farthest point along S d.
class ScaledCustom final : public CustomConvex {
public:
    ScaledCustom(std::shared_ptr<const CustomConvex> inner, const Vector3& scale, float convexRadius)
        : CustomConvex(convexRadius), inner_(std::move(inner)), scale_(scale) {}
    Vector3 FarthestPoint(const Vector3& direction) const override {
        return inner_->FarthestPoint(direction.cwiseProduct(scale_)).cwiseProduct(scale_);
    }

protected:
    std::optional<SolidMass> KnownMass() const override {
        return ScaledMass(ToSolidMass(inner_->Mass()), scale_.cast<double>());
    }

private:
    std::shared_ptr<const CustomConvex> inner_;
    Vector3 scale_;
};

Vector3 Column(const Quaternion& q, int axis) { return Rotate(q, Vector3(Vector3::Unit(axis))); }

// Where S R = R' S' for a child's rotation R: its scale S' and its rotation R', if there are such.
bool ChildScale(const Quaternion& r, const Vector3& scale, const Vector3& size, Vector3& childScale,
                Quaternion& rotation) {
    if (IsUniform(size)) {
        // S' = S, and R' = S R S^-1 is a rotation: about the mirrored axis, backwards where the mirror turns the hand.
        const Vector3 sign(std::copysign(1.0f, scale.x()), std::copysign(1.0f, scale.y()),
                           std::copysign(1.0f, scale.z()));
        const Vector3 axis = r.Imaginary().cwiseProduct(sign) * (sign.x() * sign.y() * sign.z());
        childScale = scale;
        rotation = {axis.x(), axis.y(), axis.z(), r.w};
        return true;
    }
    // R' = R where R^T S R is diagonal: the child's axes lie along those that are scaled alike.
    const float most = size.maxCoeff();
    for (int i = 0; i < 3; ++i) {
        const Vector3 column = Column(r, i).cwiseProduct(scale);
        for (int k = 0; k < 3; ++k) {
            const float element = Dot(Column(r, k), column);
            if (i == k) childScale[i] = element;
            else if (std::fabs(element) > kSame * most) return false;
        }
    }
    rotation = r;
    return true;
}

Result<ShapePtr> ScaledCompound(const CompoundShape& compound, const Vector3& scale, const Vector3& size) {
    std::vector<CompoundShape::ChildSettings> children = compound.Settings();
    Vector3 center = Vector3::Zero();  // of the children alone; where it is not the compound's, it was offset
    float mass = 0;
    for (CompoundShape::ChildSettings& child : children) {
        const float childMass = child.density * child.shape->Mass().volume;
        center += (child.position + Rotate(child.rotation, child.shape->Mass().centerOfMass)) * childMass;
        mass += childMass;
        Vector3 childScale;
        Quaternion rotation;
        if (!ChildScale(child.rotation, scale, size, childScale, rotation))
            return NotThat(compound, scale, NearestUniform(scale));
        Result<ShapePtr> scaled = Scaled(child.shape, childScale);
        if (!scaled) return scaled.GetError();
        child = {scaled.Value(), child.position.cwiseProduct(scale), rotation, child.density};
    }
    if (compound.Type() == ShapeType::MutableCompound) return AsShape(MutableCompound::Create(children));
    Vector3 offset = compound.Mass().centerOfMass - center * (1 / mass);
    if (Length(offset) <= 1e-5f * compound.OuterRadius()) offset = Vector3::Zero();
    return AsShape(Compound::Create(children, offset.cwiseProduct(scale)));
}

// The shape as children of a compound.
Result<std::vector<Compound::ChildSettings>> AsChildren(const ShapePtr& shape) {
    if (!shape) return Error{ErrorCode::Unsupported, "shape is null"};
    if (shape->IsCompound()) return static_cast<const CompoundShape&>(*shape).Settings();
    return std::vector<Compound::ChildSettings>{{.shape = shape}};
}

}  // namespace

Result<ShapePtr> Scaled(const ShapePtr& shape, const Vector3& scale) {
    const DefaultFloats floats;
    if (!shape) return Error{ErrorCode::Unsupported, "shape is null"};
    if (!IsFinite(scale)) return Error{ErrorCode::NonFinite, "scale is not finite"};
    const Vector3 size = scale.cwiseAbs();
    if (!(size.minCoeff() > 0)) {
        return Error{ErrorCode::OutOfRange, Message("scale is (%g, %g, %g): no factor may be 0", double{scale.x()},
                                                    double{scale.y()}, double{scale.z()})};
    }
    switch (shape->Type()) {
        case ShapeType::Box: {
            const auto& box = static_cast<const Box&>(*shape);
            return AsShape(Box::Create(box.HalfExtents().cwiseProduct(size), box.ConvexRadius() * size.minCoeff()));
        }
        case ShapeType::ConvexHull: return ScaledHull(static_cast<const ConvexHull&>(*shape), scale);
        case ShapeType::Triangle: return ScaledTriangle(static_cast<const Triangle&>(*shape), scale, size);
        case ShapeType::Cylinder: return ScaledCylinder(static_cast<const Cylinder&>(*shape), scale, size);
        case ShapeType::Compound:
        case ShapeType::MutableCompound: return ScaledCompound(static_cast<const CompoundShape&>(*shape), scale, size);
        case ShapeType::Empty: return shape;
        case ShapeType::TriangleMesh:
            return AsShape(TriangleMesh::Scaled(static_cast<const TriangleMesh&>(*shape), scale));
        case ShapeType::HeightField:
            return Error{ErrorCode::Unsupported,
                         "a height field cannot be scaled: make one of other cell sizes and heights"};
        case ShapeType::Plane: {
            const auto& plane = static_cast<const Plane&>(*shape);
            const Vector3 normal = plane.Normal().cwiseQuotient(scale);
            return AsShape(Plane::Create(normal, plane.Offset() / Length(normal)));
        }
        case ShapeType::Custom: {
            const auto custom = std::static_pointer_cast<const CustomConvex>(shape);
            if (custom->ConvexRadius() > 0 && !IsUniform(size)) return NotThat(*shape, scale, NearestUniform(scale));
            return AsShape(CreateCustom<ScaledCustom>(custom, scale, custom->ConvexRadius() * size.minCoeff()));
        }
        case ShapeType::Sphere:
        case ShapeType::Capsule:
        case ShapeType::TaperedCapsule: break;
    }
    if (!IsUniform(size)) return NotThat(*shape, scale, NearestUniform(scale));
    if (shape->Type() == ShapeType::Sphere)
        return AsShape(Sphere::Create(static_cast<const Sphere&>(*shape).Radius() * size.x()));
    if (shape->Type() == ShapeType::Capsule) {
        const auto& capsule = static_cast<const Capsule&>(*shape);
        return AsShape(Capsule::Create(capsule.HalfHeight() * size.x(), capsule.Radius() * size.x()));
    }
    const auto& drop = static_cast<const TaperedCapsule&>(*shape);
    const float top = drop.TopRadius() * size.x(), bottom = drop.BottomRadius() * size.x();
    const bool upsideDown = scale.y() < 0;
    return AsShape(
        TaperedCapsule::Create(drop.HalfHeight() * size.x(), upsideDown ? bottom : top, upsideDown ? top : bottom));
}

Result<ShapePtr> RotatedTranslated(const ShapePtr& shape, const Vector3& position, const Quaternion& rotation) {
    const DefaultFloats floats;
    Result<std::vector<Compound::ChildSettings>> children = AsChildren(shape);
    if (!children) return children.GetError();
    for (Compound::ChildSettings& child : children.Value()) {
        child.position = position + Rotate(rotation, child.position);
        child.rotation = rotation * child.rotation;
    }
    return AsShape(Compound::Create(children.Value()));
}

Result<ShapePtr> OffsetCenterOfMass(const ShapePtr& shape, const Vector3& offset) {
    const DefaultFloats floats;
    const Result<std::vector<Compound::ChildSettings>> children = AsChildren(shape);
    if (!children) return children.GetError();
    return AsShape(Compound::Create(children.Value(), offset));
}

}  // namespace fulcrum
