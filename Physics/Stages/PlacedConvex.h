// A convex shape with an offset from the body's center, as a shape in the body's center frame. Used by the casts of
// Continuous and Sense; any number of threads.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// It rotates with the body.
class PlacedConvex final : public ConvexShape {
public:
    PlacedConvex(const ConvexShape& shape, const RelativePose& local)
        : ConvexShape(ShapeType::Custom), shape_(shape), local_(local) {
        convexRadius_ = shape.ConvexRadius();
        innerRadius_ = shape.InnerRadius();
        outerRadius_ = shape.OuterRadius() + Length(local.position);
        bounds_.lower = Vector3::Constant(-outerRadius_);
        bounds_.upper = Vector3::Constant(outerRadius_);
    }
    Vector3 SupportCore(const Vector3& direction) const override {
        return local_.Transform(shape_.SupportCore(InverseRotate(local_.rotation, direction)));
    }

private:
    const ConvexShape& shape_;
    RelativePose local_;
};

}  // namespace fulcrum
