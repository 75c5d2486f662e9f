// Points and triangles as convex shapes, for GJK in the queries. They live on the stack of one call; bodies do not use
// them.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

// A ball of radius zero at the origin.
class PointCore final : public ConvexShape {
public:
    PointCore() : ConvexShape(ShapeType::Sphere) { bounds_.lower = bounds_.upper = Vector3::Zero(); }
    Vector3 SupportCore(const Vector3&) const override { return Vector3::Zero(); }
};

// A triangle of a surface, relative to a point near it.
class TriangleCore final : public ConvexShape {
public:
    // `origin`: the origin of the new frame, in the surface's frame, m.
    TriangleCore(const TriangleView& triangle, const Vector3& origin)
        : ConvexShape(ShapeType::Custom),
          normal_(triangle.normal),
          id_(triangle.id),
          activeEdges_(triangle.activeEdges) {
        for (int i = 0; i < 3; ++i) {
            vertices_[i] = triangle.vertices[i] - origin;
            bounds_.Include(vertices_[i]);
            const float radius = Length(vertices_[i]);
            outerRadius_ = radius > outerRadius_ ? radius : outerRadius_;
        }
    }
    Vector3 SupportCore(const Vector3& d) const override {
        const float a = Dot(d, vertices_[0]), b = Dot(d, vertices_[1]), c = Dot(d, vertices_[2]);
        return a >= b ? (a >= c ? vertices_[0] : vertices_[2]) : (b >= c ? vertices_[1] : vertices_[2]);
    }
    const Vector3 (&Corners() const)[3] { return vertices_; }
    const Vector3& Normal() const { return normal_; }
    uint32_t Id() const { return id_; }
    uint8_t ActiveEdges() const { return activeEdges_; }  // see TriangleView

private:
    Vector3 vertices_[3];
    Vector3 normal_;
    uint32_t id_;
    uint8_t activeEdges_;
};

}  // namespace fulcrum
