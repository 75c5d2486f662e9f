// The convex pieces (children, triangles) of a shape near a box, each at its pose. Used by shape casts, distances and
// overlaps; half spaces, which have no pieces, are handled by the callers. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Queries/SubShape.h>
#include <Fulcrum/Collision/Shapes/CompoundShape.h>

namespace fulcrum {

struct Piece {
    const ConvexShape& shape;
    RelativePose pose;  // in the frame of its shape
    SubShape subShape;
    const TriangleCore* triangle = nullptr;  // the piece, if it is a triangle
    bool isTwoSided = true;                  // of the surface
};

// Shapes farther apart than this are not found: squares of distances must be finite floats. Also rejects invalid
// rotations.
inline constexpr double kFarthestApart = 1e18;  // m
inline bool IsWithinReach(const Position& between) {
    return IsFinite(between) && between.cwiseAbs().maxCoeff() < kFarthestApart;
}
inline bool IsRotation(const Quaternion& q) { return IsFinite(q) && Abs(LengthSquared(q) - 1) < 0.01f; }

inline Bounds Inflated(const Bounds& bounds, float by) {
    Bounds b;
    b.lower = bounds.lower - Vector3::Constant(by);
    b.upper = bounds.upper + Vector3::Constant(by);
    return b;
}

// The box moved, enlarged by the rounding.
inline Bounds Shifted(const Bounds& bounds, const Vector3& by) {
    if (by.isZero(0)) return bounds;
    const float slack = 1e-6f * (by.cwiseAbs().sum() + bounds.lower.cwiseAbs().sum() + bounds.upper.cwiseAbs().sum());
    Bounds b;
    b.lower = bounds.lower + by - Vector3::Constant(slack);
    b.upper = bounds.upper + by + Vector3::Constant(slack);
    return b;
}

// The AABB of a box at `pose`, enlarged by the rounding.
inline Bounds BoundsAt(const RelativePose& pose, const Bounds& bounds) {
    const Matrix3 r = ToMatrix(pose.rotation);
    const Vector3 half = bounds.HalfExtents(), center = pose.Transform(bounds.Center());
    const Vector3 reach = r.x.cwiseAbs() * half.x() + r.y.cwiseAbs() * half.y() + r.z.cwiseAbs() * half.z();
    const float slack = 1e-6f * (reach.sum() + center.cwiseAbs().sum());
    Bounds b;
    b.lower = center - reach - Vector3::Constant(slack);
    b.upper = center + reach + Vector3::Constant(slack);
    return b;
}

// Bounds, relative to `origin`, of a shape whose center frame is at `center`; rounded outwards.
inline Bounds BoundsAbout(const Position& origin, const Shape& shape, const Pose& center) {
    const Bounds turned = BoundsAt({Vector3::Zero(), center.rotation}, shape.LocalBounds());
    const Position at = center.position - origin;
    return RoundedOutwards(at + turned.lower.cast<double>(), at + turned.upper.cast<double>());
}

template <class Visitor>
void VisitChild(const CompoundShape& compound, uint32_t child, Visitor&& visit) {
    const CompoundShape::Child& entry = compound.ChildAt(child);
    visit(Piece{*entry.shape, compound.PoseOf(entry), {child, kNoTriangle}});
}

template <class Visitor>
void VisitTriangle(const SurfaceShape& surface, uint32_t id, Visitor&& visit) {
    const TriangleView view = surface.GetTriangle(id);
    const Vector3 origin = view.vertices[0];
    const TriangleCore triangle(view, origin);
    visit(Piece{triangle, {origin, {}}, {0, id}, &triangle, surface.IsTwoSided()});
}

// Calls visit(const Piece&) for the pieces whose boxes overlap `box`, which is in the shape's frame; a convex shape is
// its own piece and always visited. Not for half spaces.
template <class Visitor>
void VisitPieces(const Shape& shape, const Bounds& box, Visitor&& visit) {
    if (shape.IsConvex()) {
        visit(Piece{static_cast<const ConvexShape&>(shape), {}, {}});
    } else if (shape.IsCompound()) {
        const CompoundShape& compound = static_cast<const CompoundShape&>(shape);
        compound.Tree().Query(Shifted(box, -compound.Origin()),
                              [&](uint32_t child) { VisitChild(compound, child, visit); });
    } else if (shape.IsSurface()) {
        const SurfaceShape& surface = static_cast<const SurfaceShape&>(shape);
        surface.VisitTriangles(box, [&](uint32_t id) { VisitTriangle(surface, id, visit); });
    }
}

// The same for the pieces whose boxes are within maxDistance m of `box`, nearer ones mostly first. The visitor may
// lower maxDistance; below 0 ends the search.
template <class Visitor>
void VisitPiecesNear(const Shape& shape, const Bounds& box, const float& maxDistance, Visitor&& visit) {
    if (shape.IsConvex()) {
        visit(Piece{static_cast<const ConvexShape&>(shape), {}, {}});
    } else if (shape.IsCompound()) {
        const CompoundShape& compound = static_cast<const CompoundShape&>(shape);
        compound.Tree().VisitNear(Shifted(box, -compound.Origin()), maxDistance,
                                  [&](uint32_t child) { VisitChild(compound, child, visit); });
    } else if (shape.IsSurface()) {
        const SurfaceShape& surface = static_cast<const SurfaceShape&>(shape);
        surface.VisitTrianglesNear(box, maxDistance, [&](uint32_t id) { VisitTriangle(surface, id, visit); });
    }
}

}  // namespace fulcrum
