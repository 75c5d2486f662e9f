// Casts a convex shape that moves along a line and may rotate at a constant rate against a single shape at a pose.
// Called by the world's queries and continuous collision, and by users who have shapes and no world. Thread-safe;
// allocates nothing unless the depth of a degenerate overlap is measured, with the method Libccd, or when a thread
// first casts with ignoreSeparating.
//
// No hit is missed, however thin or fast the shapes. Shapes that overlap at the start are hit at fraction 0, with
// penetration depth and normal. One-sided triangles are only hit from the front: a shape that moves along their normal,
// or reaches them from behind, passes. A motion that is not finite, or longer than 1e18 m or rad, or from farther away,
// hits nothing; one of zero length hits what it overlaps.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Queries/SubShape.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

#include <type_traits>

namespace fulcrum {

class Bearings;
class Plane;
class SurfaceShape;
struct CoreMotion;
struct Piece;

struct ShapeMotion {
    Pose pose{};                             // of the shape's center frame at the start
    Vector3 displacement = Vector3::Zero();  // m, of the center, over the whole motion
    Vector3 turn = Vector3::Zero();          // rad, over the whole motion: the rotation vector, about the center
    // The same for the other shape, about its own center. Only for convex shapes.
    Vector3 turnOfOther = Vector3::Zero();
};

// Settings out of range hit nothing.
struct ShapeCastSettings {
    bool backFaces = false;  // triangles are hit from behind
    float maxFraction = 1;   // 0 .. 1, of the motion; only hits up to here
    float separation = 0;    // m, >= 0: shapes this far apart count as touching
    float tolerance = 0;     // m, >= 0: a hit may be reported this much too late; 0: to about 1e-6 of the shapes' size
    // A shape that touches or overlaps at the start is not hit if the motion begins along its surface or out of it, as
    // for a character that stands on a floor and walks. Nor is, later, what only continues that surface: other
    // triangles, children or bodies that lie below it, or above it by at most a millimeter, of small shapes by at most
    // a hundredth of the outer radius of the one that moves. Hits at inactive edges (SurfaceShape.h) have the normal of
    // the face. A motion of zero length hits nothing at the start.
    bool ignoreSeparating = false;
    bool measureDepth = true;  // otherwise overlaps at the start have depth, normal and position zero

    bool IsValid() const;
};

struct ShapeHit {
    float fraction = 0;                    // of the motion
    SubShape subShape{};                   // of the other shape
    Vector3 normal = Vector3::Zero();      // unit, from the other shape towards the one that moves
    Position position = Position::Zero();  // m, on the surface of the other shape
    float depth = 0;                       // m, >= 0: how far they overlap at the start
    bool isEarly = false;  // iteration limit reached: they do not touch before, but maybe later or never
};

// Everything is in the frame of the motion (the world's or another), and precise however far from its origin.
class ShapeCaster {
public:
    ShapeCaster(const ConvexShape& shape, const ShapeMotion& motion,
                NarrowPhaseMethod method = NarrowPhaseMethod::Automatic);
    bool IsValid() const { return isValid_; }  // else it hits nothing
    // A box, relative to the moving center, that contains the shape during the whole motion.
    const Bounds& BoundsAboutCenter() const { return bounds_; }

    // The closest hit; ties are resolved by the deepest, then the lowest child and triangle. `pose` is that of the
    // other shape's center frame. Returns false, leaving `hit` unchanged, if there is none.
    bool CastClosest(const Shape& other, const Pose& pose, const ShapeCastSettings& settings, ShapeHit& hit) const;
    // Calls visit(const ShapeHit&) for the first hit of each convex shape, child, triangle or half space, in no
    // particular order, until it returns false. Returns false if it did.
    template <class Visitor>
    bool CastAll(const Shape& other, const Pose& pose, const ShapeCastSettings& settings, Visitor&& visit) const;
    // The same, but visit(const ShapeHit&) returns the new largest fraction, negative to stop.
    template <class Visitor>
    void Visit(const Shape& other, const Pose& pose, const ShapeCastSettings& settings, Visitor&& visit) const;

    // Casts with ignoreSeparating against several shapes: adds the planes on which the moving shape rests at the start
    // where it touches one of them; RestOn tells casts of all of them (not owned). Without, each cast has those of its
    // own shape.
    void FindBearings(const Shape& other, const Pose& pose, const ShapeCastSettings& settings,
                      Bearings& bearings) const;
    void RestOn(const Bearings& bearings) { bearings_ = &bearings; }
    // m: up to this distance a shape counts as touching there.
    float ReachOfBearings(const ShapeCastSettings& settings) const;

private:
    // Visits a hit and may lower settings.maxFraction; false ends the search.
    using HitFunction = bool (*)(void* context, const ShapeHit& hit, ShapeCastSettings& settings);
    void Search(const Shape& other, const Pose& pose, ShapeCastSettings settings, void* context,
                HitFunction found) const;
    void SearchSurface(const SurfaceShape& surface, const Pose& pose, ShapeCastSettings& settings, void* context,
                       HitFunction found) const;
    // `turn`: of the piece, about its center, over the whole motion.
    bool CastPiece(const Piece& piece, const Pose& pose, const ShapeCastSettings& settings, ShapeHit& hit,
                   const Vector3& turn = Vector3::Zero()) const;
    bool CastPlane(const Shape& plane, const Pose& pose, const ShapeCastSettings& settings, ShapeHit& hit) const;
    // Whether the motion at its start leads out of the overlapping shape, or along its surface.
    bool Separates(const ShapeHit& hit) const;
    // Whether a piece is hidden by a bearing.
    bool Continues(const ConvexShape& piece, const Pose& at) const;
    void AddBearing(const ShapeHit& touched, Bearings& bearings) const;
    bool MeasureDepth(const Piece& piece, const Pose& at, const CoreMotion& motion, const ShapeCastSettings& settings,
                      float reach, ShapeHit& hit) const;
    double HeightAbove(const Plane& plane, const CoreMotion& motion) const;
    CoreMotion RelativeTo(const Pose& pose) const;

    const ConvexShape& shape_;
    ShapeMotion motion_;
    Bounds bounds_;
    NarrowPhaseMethod method_;
    const Bearings* bearings_ = nullptr;
    bool isValid_ = false;
};

template <class Visitor>
bool ShapeCaster::CastAll(const Shape& other, const Pose& pose, const ShapeCastSettings& settings,
                          Visitor&& visit) const {
    struct Context {
        std::remove_reference_t<Visitor>& visit;
        bool goOn = true;
    } all{visit};
    Search(other, pose, settings, &all, [](void* context, const ShapeHit& hit, ShapeCastSettings&) -> bool {
        Context& c = *static_cast<Context*>(context);
        return c.goOn = c.visit(hit);
    });
    return all.goOn;
}

template <class Visitor>
void ShapeCaster::Visit(const Shape& other, const Pose& pose, const ShapeCastSettings& settings,
                        Visitor&& visit) const {
    Search(other, pose, settings, &visit, [](void* context, const ShapeHit& hit, ShapeCastSettings& limits) -> bool {
        const float largest = (*static_cast<std::remove_reference_t<Visitor>*>(context))(hit);
        if (largest < limits.maxFraction) limits.maxFraction = largest;
        return limits.maxFraction >= 0;
    });
}

}  // namespace fulcrum
