#include <Fulcrum/Collision/Queries/ShapeCast.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleSide.h>
#include <Fulcrum/Collision/Queries/Bearings.h>
#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/CoreCast.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace fulcrum {

namespace {

Position InverseRotateExactly(const Quaternion& q, const Position& v) {
    return Rotate<double>(Quat<double>{-q.x, -q.y, -q.z, q.w}, v);
}

Bounds BoundsOfTurning(const ConvexShape& shape, const ShapeMotion& motion) {
    if (motion.turn.isZero(0)) return BoundsAt({Vector3::Zero(), motion.pose.rotation}, shape.LocalBounds());
    return Inflated({Vector3::Zero(), Vector3::Zero()}, shape.OuterRadius() * 1.000001f);
}

// Whether a hit is within maxFraction is decided when it is rounded to float: shapes that are hit at the same fraction
// are then found in any order, each within the fraction of the other. The search goes as much further.
CoreCastLimits LimitsOf(const ShapeCastSettings& settings) {
    return {double{settings.maxFraction} * (1 + 0x1p-22), settings.separation, settings.tolerance};
}
bool IsWithin(const CoreCastResult& cast, const ShapeCastSettings& settings) {
    return cast.IsHit() && static_cast<float>(cast.fraction) <= settings.maxFraction;
}

}  // namespace

bool ShapeCastSettings::IsValid() const {
    const DefaultFloats floats;
    return maxFraction >= 0 && separation >= 0 && tolerance >= 0 && IsWithinReach(Position(separation, tolerance, 0));
}

ShapeCaster::ShapeCaster(const ConvexShape& shape, const ShapeMotion& motion, NarrowPhaseMethod method)
    : shape_(shape), motion_(motion), method_(method) {
    const DefaultFloats floats;
    bounds_ = BoundsOfTurning(shape, motion);
    isValid_ = IsFinite(motion.pose.position) && IsRotation(motion.pose.rotation) &&
               IsWithinReach(motion.displacement.cast<double>()) && IsWithinReach(motion.turn.cast<double>()) &&
               IsWithinReach(motion.turnOfOther.cast<double>()) && IsFinite(bounds_.lower) && IsFinite(bounds_.upper);
}

CoreMotion ShapeCaster::RelativeTo(const Pose& pose) const {
    CoreMotion motion;
    motion.position = InverseRotateExactly(pose.rotation, motion_.pose.position - pose.position);
    motion.rotation = pose.rotation.Conjugate() * motion_.pose.rotation;
    motion.displacement = InverseRotate(pose.rotation, motion_.displacement);
    if (!motion_.turn.isZero(0)) motion.turn = InverseRotate(pose.rotation, motion_.turn);
    return motion;
}

namespace {

// Hits that overflow, of shapes of extreme sizes or distances, do not count.
bool IsWithinFloats(const ShapeHit& hit) {
    return std::fabs(LengthSquared(hit.normal) - 1) < 1e-3f && IsFinite(hit.position) && std::isfinite(hit.depth);
}

// The normal of a triangle's face that replaces that of a contact at one of its inactive edges or corners, in the
// triangle's frame; `center`: of the other shape.
std::optional<Vector3> FaceInsteadOfEdge(const Piece& piece, const Vector3& normal, const Position& center,
                                         const ShapeCastSettings& settings) {
    if (!piece.triangle || !settings.ignoreSeparating) return std::nullopt;
    const TriangleCore& triangle = *piece.triangle;
    Vector3 face = triangle.Normal();
    if ((piece.isTwoSided || settings.backFaces) &&
        Dot<double>(center - triangle.Corners()[0].cast<double>(), face.cast<double>()) < 0)
        face = -face;
    const bool stays = Dot(normal, face) > kFaceCosine ||
                       FeatureAlong(triangle.Corners(), triangle.ActiveEdges(), Vector3(-normal)).isActive;
    return stays ? std::nullopt : std::optional(face);
}

}  // namespace

// Depth and normal where the shapes overlap at the start, or are up to `reach` m apart; false if they are farther. Of a
// one-sided triangle towards its front.
bool ShapeCaster::MeasureDepth(const Piece& piece, const Pose& at, const CoreMotion& motion,
                               const ShapeCastSettings& settings, float reach, ShapeHit& hit) const {
    const RelativePose relative{motion.position.cast<float>(), motion.rotation};
    const ConvexSeparation now = MeasureConvex(piece.shape, shape_, relative, reach, method_);
    if (now.isBeyond) return false;
    Vector3 normal = now.normal, onA = now.onA;
    hit.depth = std::max(0.0f, -now.separation);
    std::optional<Vector3> face = FaceInsteadOfEdge(piece, normal, motion.position, settings);
    if (piece.triangle && !piece.isTwoSided && Dot(normal, piece.triangle->Normal()) < 0)
        face = piece.triangle->Normal();
    if (face) {
        normal = *face;
        const Vector3 deepest = relative.Transform(shape_.Support(InverseRotate(relative.rotation, Vector3(-normal))));
        const float height = Dot(normal, Vector3(deepest - piece.triangle->SupportCore(normal)));
        hit.depth = std::max(0.0f, -height);
        onA = deepest - normal * height;
    }
    hit.normal = Rotate(at.rotation, normal);
    hit.position = at.Transform(onA);
    return IsWithinFloats(hit);
}

// A motion along a surface is not exactly parallel to it, due to rounding: one that penetrates by less than this over
// its whole length counts as parallel.
bool ShapeCaster::Separates(const ShapeHit& hit) const {
    constexpr float kAlong = 1e-4f;  // of the motion
    const Position center = motion_.pose.position + motion_.displacement.cast<double>() * double{hit.fraction};
    const Vector3 arm = (hit.position - center).cast<float>();
    const Vector3 motion = motion_.displacement + Cross<float>(motion_.turn, arm);
    return Dot(motion, hit.normal) >= -kAlong * Length(motion);
}

bool ShapeCaster::CastPiece(const Piece& piece, const Pose& pose, const ShapeCastSettings& settings, ShapeHit& hit,
                            const Vector3& turn) const {
    const Pose at = pose * piece.pose;
    if (settings.ignoreSeparating && Continues(piece.shape, at)) return false;
    CoreMotion motion = RelativeTo(at);
    if (!turn.isZero(0)) motion.turnOfA = InverseRotate(at.rotation, turn);
    if (!IsWithinReach(motion.position)) return false;
    const bool isOneSided = piece.triangle && !piece.isTwoSided && !settings.backFaces;
    if (isOneSided && !motion.IsTurning() && Dot(motion.displacement, piece.triangle->Normal()) > 0) return false;
    const CoreCastResult cast = CastCore(piece.shape, shape_, motion, LimitsOf(settings), method_);
    if (!IsWithin(cast, settings)) return false;
    hit = {};
    hit.subShape = piece.subShape;
    hit.fraction = static_cast<float>(cast.fraction);
    hit.isEarly = cast.status == CoreCastResult::Status::Early;
    if (cast.status == CoreCastResult::Status::AtStart) {
        if (!settings.measureDepth && !settings.ignoreSeparating) return true;
        constexpr float kAnyReach = std::numeric_limits<float>::infinity();
        if (!MeasureDepth(piece, at, motion, settings, kAnyReach, hit)) return false;
        if (settings.ignoreSeparating && Separates(hit)) return false;
        if (!settings.measureDepth) hit = {.fraction = hit.fraction, .subShape = hit.subShape, .isEarly = hit.isEarly};
        return true;
    }
    if (isOneSided && motion.IsTurning()) {
        // A rotating shape may touch an open edge from any side: its center determines from which side it comes.
        const Position center =
            motion.PositionAt(cast.fraction) - piece.triangle->SupportCore(Vector3(1, 0, 0)).cast<double>();
        if (Dot<double>(center, piece.triangle->Normal().cast<double>()) < 0) return false;
    }
    hit.normal = Rotate(at.rotation, cast.normal);
    hit.position = at.Transform(cast.onA + cast.normal * piece.shape.ConvexRadius());
    if (const auto face = FaceInsteadOfEdge(piece, cast.normal, motion.PositionAt(cast.fraction), settings)) {
        hit.normal = Rotate(at.rotation, *face);
        if (Separates(hit)) return false;
    }
    return IsWithinFloats(hit);
}

// m, of the shape's lowest point at the start above a half space.
double ShapeCaster::HeightAbove(const Plane& plane, const CoreMotion& motion) const {
    const Vector3 lowest =
        Rotate(motion.rotation, shape_.Support(InverseRotate(motion.rotation, Vector3(-plane.Normal()))));
    return Dot<double>(plane.Normal().cast<double>(), Position(motion.position + lowest.cast<double>())) -
           double{plane.Offset()};
}

bool ShapeCaster::CastPlane(const Shape& shape, const Pose& pose, const ShapeCastSettings& settings,
                            ShapeHit& hit) const {
    const Plane& plane = static_cast<const Plane&>(shape);
    const CoreMotion motion = RelativeTo(pose);
    if (!IsWithinReach(motion.position)) return false;
    const CoreCastResult cast = CastToPlane(plane.Normal(), double{plane.Offset()}, shape_, motion, LimitsOf(settings));
    if (!IsWithin(cast, settings)) return false;
    hit = {};
    hit.fraction = static_cast<float>(cast.fraction);
    hit.normal = Rotate(pose.rotation, plane.Normal());
    hit.position = pose.Transform(cast.onA);
    hit.isEarly = cast.status == CoreCastResult::Status::Early;
    if (cast.status == CoreCastResult::Status::AtStart) {
        hit.depth = std::max(0.0f, static_cast<float>(-HeightAbove(plane, motion)));
        if (settings.ignoreSeparating && Separates(hit)) return false;
    }
    return IsWithinFloats(hit);
}

// A long motion is cut into segments not much longer than the shape, so that their AABBs contain few other triangles.
void ShapeCaster::SearchSurface(const SurfaceShape& surface, const Pose& pose, ShapeCastSettings& settings,
                                void* context, HitFunction found) const {
    constexpr float kSegmentLength = 4;  // half extents
    constexpr float kMostSegments = 256;
    const CoreMotion motion = RelativeTo(pose);
    const Bounds turned =
        motion.IsTurning() ? bounds_ : BoundsAt({Vector3::Zero(), motion.rotation}, shape_.LocalBounds());
    const float size = turned.HalfExtents().maxCoeff();
    const float length = motion.displacement.cwiseAbs().maxCoeff();
    const int segments = static_cast<int>(std::clamp(std::ceil(length / (kSegmentLength * size)), 1.0f, kMostSegments));
    bool goOn = true;
    for (int i = 0; i < segments && goOn; ++i) {
        const float from = static_cast<float>(i) / static_cast<float>(segments);
        const float to = i + 1 == segments ? 1 : static_cast<float>(i + 1) / static_cast<float>(segments);
        if (from > settings.maxFraction) return;
        Bounds box;
        for (const float fraction : {from, to}) {
            const Vector3 center = motion.PositionAt(double{fraction}).cast<float>();
            box.Include(Vector3(center + turned.lower));
            box.Include(Vector3(center + turned.upper));
        }
        const float slack =
            1e-3f * size + settings.separation + settings.tolerance + 1e-6f * box.lower.cwiseAbs().maxCoeff();
        VisitPieces(surface, Inflated(box, slack), [&](const Piece& piece) {
            ShapeHit hit;
            if (!goOn || !CastPiece(piece, pose, settings, hit)) return;
            // Each segment reports the hits within it, so that a triangle near two of them is reported once.
            const bool isHere = (hit.fraction >= from || i == 0) && (hit.fraction < to || i + 1 == segments);
            if (isHere) goOn = found(context, hit, settings);
        });
    }
}

void ShapeCaster::Search(const Shape& other, const Pose& pose, ShapeCastSettings settings, void* context,
                         HitFunction found) const {
    const DefaultFloats floats;
    if (!isValid_ || !settings.IsValid() || !IsWithinReach(motion_.pose.position - pose.position)) return;
    if (settings.ignoreSeparating && !bearings_) {
        Bearings bearings;
        FindBearings(other, pose, settings, bearings);
        bearings.Merge();
        ShapeCaster resting = *this;
        resting.RestOn(bearings);
        return resting.Search(other, pose, settings, context, found);
    }
    ShapeHit hit;
    if (other.IsConvex()) {
        const Piece piece{static_cast<const ConvexShape&>(other), {}, {}};
        if (CastPiece(piece, pose, settings, hit, motion_.turnOfOther)) found(context, hit, settings);
    } else if (other.Type() == ShapeType::Plane) {
        if (CastPlane(other, pose, settings, hit)) found(context, hit, settings);
    } else if (other.IsSurface()) {
        SearchSurface(static_cast<const SurfaceShape&>(other), pose, settings, context, found);
    } else if (other.IsCompound()) {
        const CompoundShape& compound = static_cast<const CompoundShape&>(other);
        const CoreMotion motion = RelativeTo(pose);
        const Bounds turned =
            motion.IsTurning() ? bounds_ : BoundsAt({Vector3::Zero(), motion.rotation}, shape_.LocalBounds());
        const float slack = settings.separation + settings.tolerance +
                            1e-6f * (other.OuterRadius() + Length(motion.displacement) +
                                     Length(Vector3(motion.position.cast<float>())));
        const TreeRay ray(motion.position + turned.Center().cast<double>() - compound.Origin().cast<double>(),
                          motion.displacement, turned.HalfExtents() + Vector3::Constant(slack));
        float limit = settings.maxFraction;
        compound.Tree().CastRay(ray, limit, [&](uint32_t child) {
            const CompoundShape::Child& entry = compound.ChildAt(child);
            if (!CastPiece({*entry.shape, compound.PoseOf(entry), {child, kNoTriangle}}, pose, settings, hit)) return;
            limit = found(context, hit, settings) ? settings.maxFraction : -1;
        });
    }
}

bool ShapeCaster::CastClosest(const Shape& other, const Pose& pose, const ShapeCastSettings& settings,
                              ShapeHit& hit) const {
    const DefaultFloats floats;
    struct Best {
        ShapeHit& hit;
        bool found = false;
    } best{hit};
    Search(other, pose, settings, &best, [](void* context, const ShapeHit& found, ShapeCastSettings& limits) -> bool {
        Best& b = *static_cast<Best*>(context);
        // Of overlaps at the start the deepest is the hit.
        const bool isCloser =
            !b.found || found.fraction < b.hit.fraction ||
            (found.fraction == b.hit.fraction &&
             (found.depth > b.hit.depth || (found.depth == b.hit.depth && found.subShape < b.hit.subShape)));
        if (!isCloser) return true;
        b.found = true;
        b.hit = found;
        limits.maxFraction = found.fraction;
        return true;
    });
    return best.found;
}

}  // namespace fulcrum
