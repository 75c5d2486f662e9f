// Base of user-defined convex shapes: a class with a support function, which collides with every other shape, has a
// mass, is found by casts and is drawn. CreateCustom fills in bounds, radii and mass; immutable afterwards.
//
//     class Egg final : public CustomConvex {
//     public:
//         Vector3 FarthestPoint(const Vector3& direction) const override { ... }
//     };
//     Result<std::shared_ptr<const Egg>> egg = CreateCustom<Egg>();
#pragma once

#include <Fulcrum/Collision/Shapes/MassProperties.h>

#include <optional>
#include <utility>

namespace fulcrum {

class CustomConvex : public ConvexShape {
public:
    // The point of the core that lies farthest along `direction` (any length > 0), in a frame of the user's choice. A
    // pure function, called by many threads at once; bit-identical on all machines if it only uses + - * / and
    // std::sqrt.
    virtual Vector3 FarthestPoint(const Vector3& direction) const = 0;

    Vector3 SupportCore(const Vector3& direction) const final { return FarthestPoint(direction) - mass_.centerOfMass; }

    // Fills bounds, radii and mass; called by CreateCustom, once.
    // Errors: NonFinite (convexRadius, or a point), Negative (convexRadius), Degenerate (no volume; or the points are
    // not the farthest ones of one convex shape: the message names a direction), OutOfRange (the inertia is no normal
    // float).
    Status Complete();

protected:
    // `convexRadius`: the shape is the core rounded by it, m, >= 0.
    explicit CustomConvex(float convexRadius = 0) : ConvexShape(ShapeType::Custom) { convexRadius_ = convexRadius; }

    // Of the whole shape at density 1, in the frame of FarthestPoint. If not given it is integrated over a mesh of 10^5
    // points and one of a quarter as many (Richardson extrapolation): exact to about 1e-6 for smooth shapes and to
    // rounding for polyhedra.
    virtual std::optional<SolidMass> KnownMass() const { return std::nullopt; }
};

// A shape of the class T, its constructor given `arguments`. Errors: those of Complete.
template <class T, class... Arguments>
Result<std::shared_ptr<const T>> CreateCustom(Arguments&&... arguments) {
    const std::shared_ptr<T> shape = std::make_shared<T>(std::forward<Arguments>(arguments)...);
    if (const Status status = shape->Complete(); !status) return status.GetError();
    return std::shared_ptr<const T>(shape);
}

}  // namespace fulcrum
