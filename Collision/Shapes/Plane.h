// Half space: solid on one side of a plane, infinite. For static and kinematic bodies. Immutable.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Extent of the bounds of infinite shapes: its square, and sums of a few squares, are finite floats.
inline constexpr float kUnboundedExtent = 1e18f;  // m

class Plane final : public Shape {
public:
    // All x with normal . x <= offset. `normal` points out of the solid and may have any length except zero; offset in
    // m. Bodies beyond kUnboundedExtent are not found. Errors: NonFinite, Degenerate (no direction), OutOfRange (the
    // offset).
    static Result<std::shared_ptr<const Plane>> Create(const Vector3& normal = Vector3(0, 1, 0), float offset = 0);
    const Vector3& Normal() const { return normal_; }  // unit
    float Offset() const { return offset_; }
    // Signed distance from the surface, negative inside.
    float Distance(const Vector3& point) const { return Dot(normal_, point) - offset_; }

private:
    Plane() : Shape(ShapeType::Plane) {}
    Vector3 normal_ = Vector3(0, 1, 0);
    float offset_ = 0;
};

}  // namespace fulcrum
