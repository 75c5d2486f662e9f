// A single triangle, as a shape of its own or as one of a surface. Created by Create, which checks it; immutable
// afterwards.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

namespace fulcrum {

// Corners in meters. `radius` > 0 makes it a rounded plate; with 0, the default, it has no thickness: both sides
// collide, and there is no inside. The mass properties are those of a flat plate of thickness 2 radius, or of 1 mm if
// the radius is 0: bodies of such triangles should be static or be given a mass. Errors: NonFinite, Negative,
// Degenerate (corners on a line), OutOfRange.
class Triangle final : public ConvexShape {
public:
    static Result<std::shared_ptr<const Triangle>> Create(const Vector3& a, const Vector3& b, const Vector3& c,
                                                          float radius = 0);

    // A triangle of a surface: corners about their centroid, m, and the unit normal. Without mass properties and radii.
    Triangle(const Vector3 (&corners)[3], const Vector3& normal)
        : ConvexShape(ShapeType::Triangle), corners_{corners[0], corners[1], corners[2]}, normal_(normal) {}

    // Corner 0, 1 or 2, relative to the triangle's centroid.
    const Vector3& Corner(int i) const { return corners_[i]; }
    // Unit; points to the side from which the corners are counter-clockwise.
    const Vector3& Normal() const { return normal_; }
    Vector3 SupportCore(const Vector3& direction) const override;
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

private:
    friend struct ShapeFileAccess;
    void Complete(float radius);  // computes the data derived from corners and radius

    Triangle() : ConvexShape(ShapeType::Triangle) {}
    Vector3 corners_[3];
    Vector3 normal_;
};

}  // namespace fulcrum
