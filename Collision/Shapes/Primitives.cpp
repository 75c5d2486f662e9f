#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Message.h>

namespace fulcrum {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Ok where the size is finite and positive; an Error that names it otherwise.
Status CheckSize(const char* name, float size) {
    if (!std::isfinite(size)) return Error{ErrorCode::NonFinite, Message("%s is %g: it must be finite", name, double{size})};
    if (!(size > 0)) return Error{ErrorCode::NonPositive, Message("%s is %g m: it must be larger than 0", name, double{size})};
    return Done{};
}

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
    const char* const names[3] = {"half extent x", "half extent y", "half extent z"};
    for (int axis = 0; axis < 3; ++axis) {
        if (const Status size = CheckSize(names[axis], halfExtents[axis]); !size) return size.GetError();
    }
    const float smallest = halfExtents.minCoeff();
    if (!std::isfinite(convexRadius)) {
        return Error{ErrorCode::NonFinite, Message("convexRadius is %g: it must be finite", double{convexRadius})};
    }
    if (convexRadius < 0 || convexRadius > smallest) {
        return Error{ErrorCode::OutOfRange, Message("convexRadius is %g m: it must be 0 to the smallest half extent, %g m",
                                                    double{convexRadius}, double{smallest})};
    }
    const double x = halfExtents.x(), y = halfExtents.y(), z = halfExtents.z(), volume = 8 * x * y * z;
    const Result<MassProperties> mass =
        AxisAlignedMass(volume, Position(y * y + z * z, x * x + z * z, x * x + y * y) * (volume / 3));
    if (!mass) return mass.GetError();

    const std::shared_ptr<Box> box(new Box);
    box->mass_ = mass.Value();
    box->convexRadius_ = convexRadius;
    box->halfExtents_ = halfExtents;
    box->bounds_ = SymmetricBounds(halfExtents);
    box->innerRadius_ = smallest;
    box->outerRadius_ = Length(halfExtents - Vector3::Constant(convexRadius)) + convexRadius;
    return std::shared_ptr<const Box>(box);
}

Vector3 Box::SupportCore(const Vector3& direction) const {
    const float x = halfExtents_.x() - convexRadius_, y = halfExtents_.y() - convexRadius_,
                z = halfExtents_.z() - convexRadius_;
    return Vector3(direction.x() < 0 ? -x : x, direction.y() < 0 ? -y : y, direction.z() < 0 ? -z : z);
}

Result<std::shared_ptr<const Capsule>> Capsule::Create(float halfHeight, float radius) {
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSize("radius", radius); !size) return size.GetError();
    // Cylinder of length 2h and two hemispheres, whose centres of mass lie 3r/8 beyond the ends of the segment:
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

}  // namespace fulcrum
