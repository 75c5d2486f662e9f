// Sphere, box and capsule. Created by their Create functions, which check the sizes; immutable afterwards.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Ball of `radius` meters, > 0. Errors: NonFinite, NonPositive, OutOfRange (the inertia is no normal float: sizes of
// about 1e-7 m or 1e7 m; so for all shapes).
class Sphere final : public ConvexShape {
public:
    static Result<std::shared_ptr<const Sphere>> Create(float radius);
    float Radius() const { return convexRadius_; }
    Vector3 SupportCore(const Vector3&) const override { return Vector3::Zero(); }
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    Sphere() : ConvexShape(ShapeType::Sphere) {}
};

// Box of half extents `halfExtents` meters, each > 0. `convexRadius` (0 .. smallest half extent) rounds its edges
// within those extents; 0, the default, keeps them sharp. The mass is that of the sharp box. Errors: NonFinite,
// NonPositive, OutOfRange.
class Box final : public ConvexShape {
public:
    static Result<std::shared_ptr<const Box>> Create(const Vector3& halfExtents, float convexRadius = 0);
    const Vector3& HalfExtents() const { return halfExtents_; }  // the rounding included
    Vector3 SupportCore(const Vector3& direction) const override;
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    friend class BoxPart;  // NarrowPhase/BoxPart.h
    Box() : ConvexShape(ShapeType::Box) {}
    void SetSize(const Vector3& halfExtents, float convexRadius);
    Vector3 halfExtents_ = Vector3::Zero();
};

// Capsule along y: a segment of half length `halfHeight` meters (> 0) and radius `radius` (> 0) about it.
// Errors: NonFinite, NonPositive, OutOfRange.
class Capsule final : public ConvexShape {
public:
    static Result<std::shared_ptr<const Capsule>> Create(float halfHeight, float radius);
    float HalfHeight() const { return halfHeight_; }
    float Radius() const { return convexRadius_; }
    Vector3 SupportCore(const Vector3& direction) const override {
        return Vector3(0, direction.y() < 0 ? -halfHeight_ : halfHeight_, 0);
    }
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    Capsule() : ConvexShape(ShapeType::Capsule) {}
    float halfHeight_ = 0;
};

}  // namespace fulcrum
