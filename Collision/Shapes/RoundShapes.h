// Tapered capsule, and the cylinder with its tapered forms. Created by their Create functions, which check the sizes;
// immutable afterwards.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Convex hull of two balls on the y axis: of `topRadius` about (0, halfHeight, 0) and `bottomRadius` about (0,
// -halfHeight, 0), meters, all > 0. Errors: NonFinite, NonPositive, Degenerate (one ball inside the other: use a Sphere
// of the larger radius), OutOfRange.
class TaperedCapsule final : public ConvexShape {
public:
    static Result<std::shared_ptr<const TaperedCapsule>> Create(float halfHeight, float topRadius, float bottomRadius);

    float HalfHeight() const { return halfHeight_; }
    float TopRadius() const { return topRadius_; }
    float BottomRadius() const { return bottomRadius_; }
    // The core is what remains of the larger ball without the smaller radius, and the smaller ball's center.
    Vector3 SupportCore(const Vector3& direction) const override;
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    TaperedCapsule() : ConvexShape(ShapeType::TaperedCapsule) {}

    float halfHeight_ = 0, topRadius_ = 0, bottomRadius_ = 0;
    // In the center frame.
    float ballY_ = 0, pointY_ = 0;  // of the core's ball and of its point, m
    float ballRadius_ = 0;          // m, >= 0
};

// Solid between two discs about y: of `topRadius` at y = halfHeight and of `bottomRadius` at y = -halfHeight, meters;
// one of the two may be 0, which makes a cone. `convexRadius` rounds the rims within those sizes, and a cone's tip,
// which then ends below its height; 0, the default, keeps them sharp: contacts are as exact and a little slower (their
// cores overlap). At most that of the largest ball inside. The mass is that of the sharp solid. Errors: NonFinite,
// NonPositive, Negative, OutOfRange (convexRadius; an inertia that is no normal float).
class Cylinder final : public ConvexShape {
public:
    static Result<std::shared_ptr<const Cylinder>> Create(float halfHeight, float radius, float convexRadius = 0);
    static Result<std::shared_ptr<const Cylinder>> CreateTapered(float halfHeight, float topRadius, float bottomRadius,
                                                                 float convexRadius = 0);
    // The tip at y = halfHeight.
    static Result<std::shared_ptr<const Cylinder>> CreateCone(float halfHeight, float radius, float convexRadius = 0);

    float HalfHeight() const { return halfHeight_; }
    float TopRadius() const { return topRadius_; }
    float BottomRadius() const { return bottomRadius_; }
    Vector3 SupportCore(const Vector3& direction) const override;
    // A disc is given as a polygon of twelve corners fixed to the body, so that a standing cylinder keeps its contacts;
    // if it leans, with the farthest point of the rim besides, so that it rolls on a circle. The side is an edge.
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    Cylinder() : ConvexShape(ShapeType::Cylinder) {}
    static Result<std::shared_ptr<const Cylinder>> Make(float halfHeight, float topRadius, float bottomRadius,
                                                        float convexRadius);
    void AddDisc(const Vector3& direction, SupportingFace& face) const;

    float halfHeight_ = 0, topRadius_ = 0, bottomRadius_ = 0;
    // Of the core, in the center frame.
    float coreTopY_ = 0, coreBottomY_ = 0, coreTopRadius_ = 0, coreBottomRadius_ = 0;
    float sideOut_ = 1, sideUp_ = 0;  // the side's unit normal: outwards and upwards
};

}  // namespace fulcrum
