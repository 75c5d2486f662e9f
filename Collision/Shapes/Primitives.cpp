#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <cmath>

namespace fulcrum {
namespace {

Result<MassProperties> AxisAlignedMass(double volume, const Position& inertia) {
    SolidMass solid;
    solid.volume = volume;
    solid.inertia.xx = inertia.x();
    solid.inertia.yy = inertia.y();
    solid.inertia.zz = inertia.z();
    return ToMassProperties(solid);
}

Bounds SymmetricBounds(const Vector3& halfExtents) {
    Bounds bounds;
    bounds.lower = -halfExtents;
    bounds.upper = halfExtents;
    return bounds;
}

}  // namespace

Result<std::shared_ptr<const Sphere>> Sphere::Create(float radius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("radius", radius); !size) return size.GetError();
    const double r = radius, volume = 4.0 / 3.0 * kPi * r * r * r;
    const Result<MassProperties> mass = AxisAlignedMass(volume, Position::Constant(0.4 * volume * r * r));
    if (!mass) return mass.GetError();

    const std::shared_ptr<Sphere> sphere(new Sphere);
    sphere->mass_ = mass.Value();
    sphere->convexRadius_ = radius;
    sphere->bounds_ = SymmetricBounds(Vector3::Constant(radius));
    sphere->innerRadius_ = sphere->outerRadius_ = radius;
    return std::shared_ptr<const Sphere>(sphere);
}

Result<std::shared_ptr<const Box>> Box::Create(const Vector3& halfExtents, float convexRadius) {
    const DefaultFloats floats;
    const char* const names[3] = {"half extent x", "half extent y", "half extent z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (const Status size = CheckSize(names[axis], halfExtents[axis]); !size) return size.GetError();
    }
    const float smallest = halfExtents.minCoeff();
    if (const Status rounding = CheckConvexRadius(convexRadius, smallest, "the smallest half extent"); !rounding)
        return rounding.GetError();
    const double x = halfExtents.x(), y = halfExtents.y(), z = halfExtents.z(), volume = 8 * x * y * z;
    const Result<MassProperties> mass =
        AxisAlignedMass(volume, Position(y * y + z * z, x * x + z * z, x * x + y * y) * (volume / 3));
    if (!mass) return mass.GetError();

    const std::shared_ptr<Box> box(new Box);
    box->mass_ = mass.Value();
    box->SetSize(halfExtents, convexRadius);
    return std::shared_ptr<const Box>(box);
}

void Box::SetSize(const Vector3& halfExtents, float convexRadius) {
    convexRadius_ = convexRadius;
    halfExtents_ = halfExtents;
    bounds_ = SymmetricBounds(halfExtents);
    innerRadius_ = halfExtents.minCoeff();
    outerRadius_ = Length(halfExtents - Vector3::Constant(convexRadius)) + convexRadius;
}

Vector3 Box::SupportCore(const Vector3& direction) const {
    const float x = halfExtents_.x() - convexRadius_, y = halfExtents_.y() - convexRadius_,
                z = halfExtents_.z() - convexRadius_;
    return Vector3(direction.x() < 0 ? -x : x, direction.y() < 0 ? -y : y, direction.z() < 0 ? -z : z);
}

void Box::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    // Of each face, which vertices: bits 0, 1, 2 say the positive x, y, z side. Counter-clockwise seen from outside.
    static constexpr uint8_t kCorners[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                               {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(direction[i]) > std::fabs(direction[axis])) axis = i;
    const bool negative = direction[axis] < 0;
    const Vector3 h = halfExtents_ - Vector3::Constant(convexRadius_);
    face.count = 0;
    for (const uint8_t corner : kCorners[2 * axis + (negative ? 1 : 0)])
        face.Add(Vector3(corner & 1 ? h.x() : -h.x(), corner & 2 ? h.y() : -h.y(), corner & 4 ? h.z() : -h.z()),
                 corner);
    face.normal = Vector3::Zero();
    face.normal[axis] = negative ? -1.0f : 1.0f;
}

Result<std::shared_ptr<const Capsule>> Capsule::Create(float halfHeight, float radius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSize("radius", radius); !size) return size.GetError();
    // Cylinder of length 2h and two hemispheres, whose centers of mass lie 3r/8 beyond the ends of the segment:
    // across, 2r^2/5 + h^2 + 3hr/4 per unit of the hemispheres' mass (parallel axes).
    const double h = halfHeight, r = radius;
    const double cylinder = 2 * kPi * r * r * h, ball = 4.0 / 3.0 * kPi * r * r * r;
    const double along = cylinder * r * r / 2 + ball * 0.4 * r * r;
    const double across = cylinder * (r * r / 4 + h * h / 3) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
    const Result<MassProperties> mass = AxisAlignedMass(cylinder + ball, Position(across, along, across));
    if (!mass) return mass.GetError();

    const std::shared_ptr<Capsule> capsule(new Capsule);
    capsule->mass_ = mass.Value();
    capsule->convexRadius_ = radius;
    capsule->halfHeight_ = halfHeight;
    capsule->bounds_ = SymmetricBounds(Vector3(radius, halfHeight + radius, radius));
    capsule->innerRadius_ = radius;
    capsule->outerRadius_ = halfHeight + radius;
    return std::shared_ptr<const Capsule>(capsule);
}

void Capsule::FindSupportingFace(const Vector3&, SupportingFace& face) const {
    face.count = 0;
    face.Add(Vector3(0, -halfHeight_, 0), 0);
    face.Add(Vector3(0, halfHeight_, 0), 1);
}

void Sphere::FindSupportingFace(const Vector3&, SupportingFace& face) const {
    face.count = 0;
    face.Add(Vector3::Zero(), 0);
}

}  // namespace fulcrum
