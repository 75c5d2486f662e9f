#include <Fulcrum/Collision/Queries/RayCast.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/Queries/ConvexRay.h>
#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

// The ray in the frame of a compound's children, widened by the rounding of its rotation.
TreeRay InFrameOfTree(const Ray& ray, double length, const CompoundShape& compound, const Pose& pose) {
    const Quat<double> back{-pose.rotation.x, -pose.rotation.y, -pose.rotation.z, pose.rotation.w};
    const Position origin =
        Rotate<double>(back, Position(ray.origin - pose.position)) - compound.Origin().cast<double>();
    // Beyond the compound the rounding of a long ray does not matter.
    const double reach = double{compound.OuterRadius()} + std::sqrt(Dot<double>(origin, origin));
    const float slack = static_cast<float>(1e-6 * (reach + std::min(reach, length)));
    constexpr double kMost = std::numeric_limits<float>::max();
    const Position displacement =
        Rotate<double>(back, ray.displacement.cast<double>()).cwiseMax(-kMost).cwiseMin(kMost);
    return TreeRay(origin, displacement.cast<float>(), Vector3::Constant(slack));
}

}  // namespace

RayCaster::RayCaster(const Ray& ray) : ray_(ray) {
    const DefaultFloats floats;
    if (!IsFinite(ray.origin) || !IsFinite(ray.displacement)) return;
    const Position displacement = ray.displacement.cast<double>();
    const double square = Dot<double>(displacement, displacement);
    if (!(square > 0)) return;
    inverseSquare_ = 1 / square;
    length_ = std::sqrt(square);
    direction_ = (displacement * (1 / length_)).cast<float>();
}

bool RayCaster::CastConvex(const ConvexShape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                           RayHit& hit) const {
    // The line's origin is the ray's closest point to the shape's center, so that its coordinates are small for rays
    // that hit.
    const Position origin = ray_.origin - pose.position, displacement = ray_.displacement.cast<double>();
    const double nearest = -Dot<double>(origin, displacement) * inverseSquare_;
    const Vector3 point = (origin + displacement * nearest).cast<float>();
    const float reach = shape.OuterRadius() * 1.0001f;
    if (LengthSquared(point) > reach * reach) return false;
    // Longer than the limit by more than later rounding errors, so that no hit within the limit is lost.
    const double upTo = (double{limit} * (1 + 0x1p-22) - nearest) * length_ + 0x1p-22 * double{reach};
    const LinePiece line{InverseRotate(pose.rotation, point), InverseRotate(pose.rotation, direction_),
                         static_cast<float>(-nearest * length_),
                         static_cast<float>(std::min(upTo, (double{settings.maxFraction} - nearest) * length_))};
    if (line.to < -reach || line.from > reach) return false;
    const LineResult found = EnterConvex(shape, line);
    if (!found.hit) return false;
    hit.subShape = {};
    hit.isBackFace = false;
    if (!found.startsInside) {
        const double fraction = nearest + double{found.entry.distance} / length_;
        hit.fraction = std::clamp(static_cast<float>(fraction), 0.0f, settings.maxFraction);
        hit.normal = Rotate(pose.rotation, found.entry.normal);
        return true;
    }
    if (!settings.hollow) {
        hit.fraction = 0;
        hit.normal = -direction_;
        return true;
    }
    LineHit exit;
    if (!settings.backFaces || !LeaveConvex(shape, line, exit)) return false;
    hit.fraction =
        std::clamp(static_cast<float>(nearest + double{exit.distance} / length_), 0.0f, settings.maxFraction);
    hit.normal = Rotate(pose.rotation, Vector3(-exit.normal));
    hit.isBackFace = true;
    return true;
}

bool RayCaster::CastPlane(const Shape& shape, const Pose& pose, const RayCastSettings& settings, RayHit& hit) const {
    const Plane& plane = static_cast<const Plane&>(shape);
    const Vector3 normal = Rotate(pose.rotation, plane.Normal());
    const Position n = normal.cast<double>();
    const double height = Dot<double>(n, Position(ray_.origin - pose.position)) - double{plane.Offset()};
    const double fall = -Dot<double>(n, ray_.displacement.cast<double>());
    const bool isInside = height <= 0;
    if (isInside && !settings.hollow) {
        hit = {0, {}, -direction_, false};
        return true;
    }
    if (isInside ? !(settings.backFaces && fall < 0) : !(fall > 0)) return false;
    const double fraction = height / fall;
    if (fraction > double{settings.maxFraction}) return false;
    hit = {static_cast<float>(fraction), {}, isInside ? Vector3(-normal) : normal, isInside};
    return true;
}

SurfaceRay RayCaster::InFrameOf(const SurfaceShape& shape, const Pose& pose, bool backFaces, double& skipped) const {
    const Position origin = ray_.origin - pose.position, displacement = ray_.displacement.cast<double>();
    const double nearest = -Dot<double>(origin, displacement) * inverseSquare_;
    skipped = std::max(0.0, nearest - 1.0001 * double{shape.OuterRadius()} / length_);
    const Vector3 begin = (origin + displacement * skipped).cast<float>();
    const Quaternion& q = pose.rotation;
    if (q.x == 0 && q.y == 0 && q.z == 0) return {begin, ray_.displacement, backFaces};  // the common case
    return {InverseRotate(q, begin), InverseRotate(q, ray_.displacement), backFaces};
}

float RayCaster::LeftOf(const RayCastSettings& settings, float limit, double skipped) {
    return static_cast<float>(std::min(double{limit} * (1 + 0x1p-22), double{settings.maxFraction}) - skipped);
}

RayHit RayCaster::FromSurface(const SurfaceHit& found, const Pose& pose, const RayCastSettings& settings,
                              double skipped) {
    return {std::min(static_cast<float>(skipped + double{found.fraction}), settings.maxFraction),
            {0, found.triangle},
            Rotate(pose.rotation, found.normal),
            found.isBackFace};
}

bool RayCaster::CastSurface(const SurfaceShape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                            RayHit& hit) const {
    double skipped = 0;
    const SurfaceRay ray = InFrameOf(shape, pose, settings.backFaces, skipped);
    const float left = LeftOf(settings, limit, skipped);
    SurfaceHit found;
    if (left < 0 || !shape.CastRay(ray, found, left)) return false;
    hit = FromSurface(found, pose, settings, skipped);
    return true;
}

uint32_t RayCaster::CastClosest(const RayCaster* casters, uint32_t which, const SurfaceShape& shape, const Pose& pose,
                                const RayCastSettings& settings, const float* limits, RayHit* hits) {
    const DefaultFloats floats;
    SurfaceRay rays[kMostRays];
    SurfaceHit found[kMostRays];
    float left[kMostRays];
    double skipped[kMostRays];
    uint8_t rayOf[kMostRays];
    int count = 0;
    for (uint32_t bits = which; bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        if (!casters[i].IsValid()) continue;
        rays[count] = casters[i].InFrameOf(shape, pose, settings.backFaces, skipped[count]);
        left[count] = LeftOf(settings, limits[i], skipped[count]);
        rayOf[count] = static_cast<uint8_t>(i);
        count += left[count] >= 0 ? 1 : 0;
    }
    uint32_t hit = 0;
    for (uint32_t bits = shape.CastRays({rays, static_cast<size_t>(count)}, found, left); bits != 0; bits &= bits - 1) {
        const int k = std::countr_zero(bits), i = rayOf[k];
        hits[i] = FromSurface(found[k], pose, settings, skipped[k]);
        hit |= 1u << i;
    }
    return hit;
}

bool RayCaster::CastClosest(const Shape& shape, const Pose& pose, const RayCastSettings& settings, float limit,
                            RayHit& hit) const {
    const DefaultFloats floats;
    if (!IsValid()) return false;
    if (shape.IsConvex()) return CastConvex(static_cast<const ConvexShape&>(shape), pose, settings, limit, hit);
    if (shape.Type() == ShapeType::Plane) return CastPlane(shape, pose, settings, hit);
    if (shape.IsSurface()) return CastSurface(static_cast<const SurfaceShape&>(shape), pose, settings, limit, hit);
    if (!shape.IsCompound()) return false;  // empty

    const CompoundShape& compound = static_cast<const CompoundShape&>(shape);
    const TreeRay ray = InFrameOfTree(ray_, length_, compound, pose);
    bool found = false;
    compound.Tree().CastRay(ray, limit, [&](uint32_t child) {
        const CompoundShape::Child& piece = compound.ChildAt(child);
        RayHit here;
        if (!CastConvex(*piece.shape, pose * compound.PoseOf(piece), settings, limit, here) || here.fraction > limit)
            return;
        if (found && here.fraction == hit.fraction && child > hit.subShape.child) return;
        found = true;
        hit = here;
        hit.subShape.child = child;
        limit = here.fraction;
    });
    return found;
}

bool RayCaster::IsHit(const Shape& shape, const Pose& pose, const RayCastSettings& settings) const {
    const DefaultFloats floats;
    if (IsValid() && shape.IsSurface()) {
        const SurfaceShape& surface = static_cast<const SurfaceShape&>(shape);
        double skipped = 0;
        const SurfaceRay ray = InFrameOf(surface, pose, settings.backFaces, skipped);
        const double left = double{settings.maxFraction} - skipped;
        return left >= 0 && surface.IsHit(ray, static_cast<float>(left));
    }
    bool hit = false;
    CastAll(shape, pose, settings, [&](const RayHit&) {
        hit = true;
        return false;
    });
    return hit;
}

bool RayCaster::Search(const Shape& shape, const Pose& pose, const RayCastSettings& settings, void* context,
                       HitFunction found) const {
    const DefaultFloats floats;
    if (!IsValid()) return true;
    RayHit hit;
    if (shape.IsConvex() || shape.Type() == ShapeType::Plane)
        return !CastClosest(shape, pose, settings, hit) || found(context, hit);
    bool goOn = true;
    if (shape.IsCompound()) {
        const CompoundShape& compound = static_cast<const CompoundShape&>(shape);
        const TreeRay ray = InFrameOfTree(ray_, length_, compound, pose);
        float limit = settings.maxFraction;
        compound.Tree().CastRay(ray, limit, [&](uint32_t child) {
            const CompoundShape::Child& piece = compound.ChildAt(child);
            if (!goOn || !CastConvex(*piece.shape, pose * compound.PoseOf(piece), settings, settings.maxFraction, hit))
                return;
            hit.subShape.child = child;
            goOn = found(context, hit);
            if (!goOn) limit = -1;
        });
        return goOn;
    }
    if (!shape.IsSurface()) return true;  // empty
    const SurfaceShape& surface = static_cast<const SurfaceShape&>(shape);
    double skipped = 0;
    const SurfaceRay ray = InFrameOf(surface, pose, settings.backFaces, skipped);
    const float left = LeftOf(settings, settings.maxFraction, skipped);
    if (left < 0) return true;
    surface.CastRayAll(
        ray,
        [&](const SurfaceHit& at) {
            hit = FromSurface(at, pose, settings, skipped);
            goOn = found(context, hit);
            return goOn;
        },
        left);
    return goOn;
}

}  // namespace fulcrum
