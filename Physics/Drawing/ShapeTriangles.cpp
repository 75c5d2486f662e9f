#include <Fulcrum/Physics/Drawing/ShapeTriangles.h>

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace fulcrum {

namespace {

using TriangleVisitor = FunctionRef<void(const DrawnTriangle&)>;

// Of a convex shape, in its center frame.
struct ConvexTriangles {
    const ConvexShape& shape;
    const TriangleVisitor& visit;

    // Triangles of directions become those of the points that lie farthest along them: inscribed, and closed, since
    // neighbors share their directions. Those on an edge or a corner of the shape have no area.
    void OfDirections(const Vector3& a, const Vector3& b, const Vector3& c, int detail) const {
        if (detail == 0) return Emit(shape.Support(a), shape.Support(b), shape.Support(c));
        const Vector3 ab = Normalized(Vector3(a + b)), bc = Normalized(Vector3(b + c)), ca = Normalized(Vector3(c + a));
        OfDirections(a, ab, ca, detail - 1);
        OfDirections(b, bc, ab, detail - 1);
        OfDirections(c, ca, bc, detail - 1);
        OfDirections(ab, bc, ca, detail - 1);
    }
    void OfAllDirections(int detail) const {
        for (int octant = 0; octant < 8; ++octant) {
            const Vector3 x(octant & 1 ? -1.0f : 1.0f, 0, 0), y(0, octant & 2 ? -1.0f : 1.0f, 0),
                z(0, 0, octant & 4 ? -1.0f : 1.0f);
            const bool isMirrored = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
            if (isMirrored) OfDirections(x, z, y, detail);
            else OfDirections(x, y, z, detail);
        }
    }
    void OfBox(const Vector3& half) const {
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {-1.0f, 1.0f}) {
                Vector3 corners[4];
                for (int i = 0; i < 4; ++i) {
                    corners[i][axis] = side * half[axis];
                    corners[i][(axis + 1) % 3] = (i == 1 || i == 2 ? 1.0f : -1.0f) * half[(axis + 1) % 3];
                    corners[i][(axis + 2) % 3] = (i >= 2 ? 1.0f : -1.0f) * half[(axis + 2) % 3];
                }
                if (side < 0) std::swap(corners[1], corners[3]);
                Emit(corners[0], corners[1], corners[2]);
                Emit(corners[0], corners[2], corners[3]);
            }
    }
    void OfHull(const ConvexHull& hull) const {
        const auto corner = [&](const ConvexHull::Face& face, int i) {
            return hull.Vertices()[hull.Indices()[static_cast<size_t>(face.firstIndex + i)]];
        };
        for (const ConvexHull::Face& face : hull.Faces())
            for (int i = 2; i < face.cornerCount; ++i) Emit(corner(face, 0), corner(face, i - 1), corner(face, i));
    }
    void Emit(const Vector3& a, const Vector3& b, const Vector3& c) const {
        const Vector3 cross = Cross<float>(Vector3(b - a), Vector3(c - a));
        if (!cross.isZero(0)) visit({.corners = {a, b, c}});
    }
};

// In the center frame.
void VisitConvex(const ConvexShape& shape, int detail, const TriangleVisitor& visit) {
    const ConvexTriangles triangles{shape, visit};
    const bool isSharp = shape.ConvexRadius() == 0;
    if (shape.Type() == ShapeType::Box && isSharp) return triangles.OfBox(static_cast<const Box&>(shape).HalfExtents());
    if (shape.Type() == ShapeType::ConvexHull && isSharp)
        return triangles.OfHull(static_cast<const ConvexHull&>(shape));
    triangles.OfAllDirections(detail);
}

void VisitPlane(const Plane& plane, float extent, const TriangleVisitor& visit) {
    const Vector3 n = plane.Normal();
    const Vector3 across = Perpendicular(n), u = across * extent, v = Cross<float>(n, across) * extent,
                  center = n * plane.Offset();
    visit({.corners = {center - u - v, center + u - v, center + u + v}});
    visit({.corners = {center - u - v, center + u + v, center - u + v}});
}

}  // namespace

void VisitTriangles(const Shape& shape, FunctionRef<void(const DrawnTriangle&)> visit, int detail, float planeExtent) {
    const DefaultFloats floats;
    detail = std::clamp(detail, 0, 6);
    // From a center frame to the user's.
    const auto placed = [&](const Vector3& position, const Quaternion& rotation, const ConvexShape& convex) {
        VisitConvex(convex, detail, [&](const DrawnTriangle& triangle) {
            DrawnTriangle moved;
            for (int i = 0; i < 3; ++i)
                moved.corners[i] =
                    shape.Mass().centerOfMass + position + Vector3(Rotate(rotation, triangle.corners[i]));
            visit(moved);
        });
    };
    if (shape.IsConvex()) {
        placed(Vector3::Zero(), {}, static_cast<const ConvexShape&>(shape));
    } else if (shape.IsCompound()) {
        const auto& compound = static_cast<const CompoundShape&>(shape);
        for (const CompoundShape::Child& child : compound.Children()) {
            if (!child.shape) continue;
            const RelativePose pose = compound.PoseOf(child);
            placed(pose.position, pose.rotation, *child.shape);
        }
    } else if (shape.IsSurface()) {
        const auto& surface = static_cast<const SurfaceShape&>(shape);
        const float everywhere = std::numeric_limits<float>::infinity();
        Bounds all;
        all.lower = Vector3::Constant(-everywhere);
        all.upper = Vector3::Constant(everywhere);
        surface.VisitTriangles(all, [&](uint32_t id) {
            const TriangleView view = surface.GetTriangle(id);
            visit({.corners = {view.vertices[0], view.vertices[1], view.vertices[2]}, .material = view.material});
        });
    } else if (shape.Type() == ShapeType::Plane) {
        VisitPlane(static_cast<const Plane&>(shape), planeExtent, visit);
    }
}

}  // namespace fulcrum
