#include <Fulcrum/UnitTests/Random/QueryChecks.h>

#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Queries/ColliderSearch.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <sstream>

namespace fulcrum::testing {

namespace {

// Where no body is found any more, since planes end there in a world.
constexpr double kBeyondPlanes = 0.1 * double{kUnboundedExtent};  // m

// The least fraction at which the ray hits the body; 2: none.
double FractionOf(const BodyShape& body, const Ray& ray) {
    RayHit hit;
    return RayCaster(ray).CastClosest(*body.shape, body.pose, {}, hit) ? double{hit.fraction} : 2.0;
}

// Whether the ray hits it near the end that planes have in a world.
bool IsBeyondPlanes(const BodyShape& body, const Ray& ray, double fraction) {
    if (body.shape->Type() != ShapeType::Plane || fraction > 1) return false;
    return (ray.origin + ray.displacement.cast<double>() * fraction).cwiseAbs().maxCoeff() > kBeyondPlanes;
}

// The same for slightly displaced rays: anything between the least and the largest fraction is right.
std::pair<double, double> FractionsNear(const BodyShape& body, const Ray& ray) {
    const double by = ToleranceOf(body, ray.origin);
    std::pair<double, double> range{FractionOf(body, ray), 0};
    range.second = range.first;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double way : {-by, by}) {
            Ray moved = ray;
            moved.origin[axis] += way;
            const double fraction = FractionOf(body, moved);
            range = {std::min(range.first, fraction), std::max(range.second, fraction)};
        }
    }
    const double slack = by / std::max(double{Length(ray.displacement)}, DBL_MIN) + 1e-6;
    return {range.first - slack, range.second + slack};
}

std::string ToText(const BodyShape& body, const Ray& ray) {
    return Text(": a ", ShapeTypeName(body.shape->Type()), " of ", body.shape->OuterRadius(), " at ",
                body.pose.position, ", ray from ", ray.origin, " by ", ray.displacement);
}

const BodyShape* Find(const std::vector<BodyShape>& bodies, BodyId id) {
    for (const BodyShape& body : bodies)
        if (body.id == id) return &body;
    return nullptr;
}

bool IsUnit(const Vector3& normal) { return IsFinite(normal) && std::abs(LengthSquared(normal) - 1) < 1e-3f; }

}  // namespace

double ToleranceOf(const BodyShape& body, const Position& from) {
    const double size =
        std::min(double{body.shape->OuterRadius()}, body.shape->Type() == ShapeType::Plane ? 1.0 : 1e30);
    const double away = (body.pose.position - from).cwiseAbs().maxCoeff();
    return 1e-3 * size + 1e-6 * away + 1e-15 * (from.cwiseAbs().maxCoeff() + body.pose.position.cwiseAbs().maxCoeff());
}

std::vector<BodyShape> ShapesOf(const PhysicsSystem& system) {
    std::vector<BodyShape> shapes;
    system.VisitBodies([&](BodyId id) {
        const BodyInterface& bodies = system.Bodies();
        const ShapePtr shape = bodies.GetShape(id);
        if (!bodies.IsSensor(id)) shapes.push_back({id, shape, CenterPoseOf(*shape, bodies.GetPose(id))});
    });
    return shapes;
}

std::string CheckClosestInside(const std::vector<BodyShape>& bodies, const std::vector<OverlapHit>& inside,
                               const Position& point, const WorldClosest& closest) {
    if (closest.body == BodyId{}) return {};
    for (const OverlapHit& hit : inside) {
        const BodyShape* const body = Find(bodies, hit.body);
        if (body && closest.distance > std::max(0.01, ToleranceOf(*body, point)))
            return Text("a point is inside body ", hit.body.index, ", a ", ShapeTypeName(body->shape->Type()), " of ",
                        body->shape->OuterRadius(), ", and away from all", ToText(closest));
    }
    return {};
}

bool AreSame(const WorldRayHit& a, const WorldRayHit& b) {
    return a.body == b.body && a.subShape == b.subShape && a.fraction == b.fraction && a.normal == b.normal &&
           a.position == b.position && a.isBackFace == b.isBackFace;
}
bool AreSame(const WorldShapeHit& a, const WorldShapeHit& b) {
    return a.body == b.body && a.subShape == b.subShape && a.fraction == b.fraction && a.normal == b.normal &&
           a.position == b.position && a.depth == b.depth && a.isEarly == b.isEarly;
}
bool AreSame(const WorldClosest& a, const WorldClosest& b) {
    return a.body == b.body && a.subShape == b.subShape && a.subShapeOfQuery == b.subShapeOfQuery &&
           a.distance == b.distance && a.normal == b.normal && a.onBody == b.onBody && a.onQuery == b.onQuery;
}

std::string ToText(const WorldRayHit& hit) {
    return Text(" (body ", hit.body.index, " triangle ", hit.subShape.triangle, " fraction ", hit.fraction, " normal ",
                hit.normal, ")");
}
std::string ToText(const WorldShapeHit& hit) {
    return Text(" (body ", hit.body.index, " triangle ", hit.subShape.triangle, " fraction ", hit.fraction, " normal ",
                hit.normal, " position ", hit.position, " depth ", hit.depth, ")");
}
std::string ToText(const WorldClosest& hit) {
    return Text(" (body ", hit.body.index, " distance ", hit.distance, " normal ", hit.normal, ")");
}

std::string CompareRay(const std::vector<BodyShape>& bodies, const Ray& ray, const WorldRayHit& hit) {
    const bool isHit = hit.body != BodyId{};
    if (isHit && !(IsUnit(hit.normal) && IsFinite(hit.position) && hit.fraction >= 0 && hit.fraction <= 1))
        return Text("ray hit of body ", hit.body.index, " is not finite, or its normal no unit vector");
    double closest = 2;
    const BodyShape* closestBody = nullptr;
    for (const BodyShape& body : bodies) {
        const auto [least, largest] = FractionsNear(body, ray);
        if (largest < closest && !IsBeyondPlanes(body, ray, largest)) {
            closest = largest;
            closestBody = &body;
        }
        if (isHit && body.id == hit.body && (double{hit.fraction} < least || (largest > 1.5 && least > 1.5)))
            return Text("a ray hits body ", body.id.index, " at ", hit.fraction, ", which by itself it meets from ",
                        least, ToText(body, ray));
    }
    // Beyond this, trees cannot resolve the distance.
    constexpr double kFarthestApart = 1e15;  // m
    for (const BodyShape& body : bodies)
        if ((body.pose.position - bodies.front().pose.position).cwiseAbs().maxCoeff() > kFarthestApart) return {};
    const double found = isHit ? double{hit.fraction} : 2;
    if (found > closest + 1e-6)
        return Text("a ray hits at ", found, " what by itself is closer, at ", closest, ToText(*closestBody, ray));
    return {};
}

std::string CheckShapeHit(const std::vector<BodyShape>& bodies, const MovingShape& moving, const WorldShapeHit& hit) {
    if (hit.body == BodyId{}) return {};
    if (!(IsUnit(hit.normal) && IsFinite(hit.position) && std::isfinite(hit.depth) && hit.fraction >= 0 &&
          hit.fraction <= 1))
        return Text("shape hit is not finite, or its normal no unit vector", ToText(hit));
    const BodyShape* const body = Find(bodies, hit.body);
    if (!body) return "a shape hits what is no body";
    if (hit.isEarly) return {};
    const Shape& shape = *moving.shape;
    Pose center = CenterPoseOf(shape, moving.pose);
    center.position += moving.displacement.cast<double>() * double{hit.fraction};
    const float angle = Length(moving.turn);
    if (angle > 100) return {};  // the rounding of so many radians to float is too large
    if (angle > 0)
        center.rotation = Normalized(RotationFromVector(Vector3(moving.turn * hit.fraction)) * center.rotation);
    ClosestPoints closest;
    const RelativePose pose = Relative(body->pose, center);
    // The fraction is a float: along a way of 10^6 m it tells places apart by a decimeter.
    const double rounding = double{Length(moving.displacement)} * 0x1p-23;
    const double tolerance = ToleranceOf(*body, center.position) + 2e-3 * double{shape.OuterRadius()} + rounding;
    if (!IsFinite(pose.position) || !FindClosestPoints(*body->shape, shape, pose, FLT_MAX, closest)) return {};
    if (double{closest.distance} > tolerance)
        return Text("a shape hits body ", body->id.index, " at ", hit.fraction, ", but is ", closest.distance,
                    " m away there");
    return {};
}

std::string CompareClosest(const std::vector<BodyShape>& bodies, const PlacedShape& placed, float maxDistance,
                           const WorldClosest& closest) {
    const bool isFound = closest.body != BodyId{};
    if (isFound && !(IsFinite(closest.normal) && std::isfinite(closest.distance) && IsFinite(closest.onBody) &&
                     IsFinite(closest.onQuery)))
        return Text("closest points are not finite", ToText(closest), " of ", closest.onBody, " and ", closest.onQuery);
    const Pose center = CenterPoseOf(*placed.shape, placed.pose);
    for (const BodyShape& body : bodies) {
        ClosestPoints here;
        if (!FindClosestPoints(*body.shape, *placed.shape, Relative(body.pose, center), maxDistance, here)) continue;
        const double tolerance = ToleranceOf(body, center.position) + 1e-3 * double{placed.shape->OuterRadius()};
        if (std::abs(double{here.distance}) > kBeyondPlanes) continue;
        if (!isFound && double{here.distance} < double{maxDistance} - tolerance)
            return Text("no body is found within ", maxDistance, " m, but body ", body.id.index, " is ", here.distance,
                        " m away");
        // If the overlap exceeds the thickness of the thinner shape, any separating direction is accepted: EPA ends
        // after an iteration limit.
        const float thickness = 2 * std::min(body.shape->InnerRadius(), placed.shape->InnerRadius());
        const double depth = std::max(double{here.distance}, -double{thickness});
        if (isFound && depth < double{closest.distance} - tolerance)
            return Text("the closest to a ", ShapeTypeName(placed.shape->Type()), " of ", placed.shape->OuterRadius(),
                        " is", ToText(closest), ", but body ", body.id.index, ", a ", ShapeTypeName(body.shape->Type()),
                        " of ", body.shape->OuterRadius(), ", is ", here.distance, " m away");
    }
    return {};
}

std::string CheckClosest(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA,
                         const ClosestPoints& closest) {
    if (!std::isfinite(closest.distance) || !IsUnit(closest.normal) || !IsFinite(closest.onA) || !IsFinite(closest.onB))
        return Text("closest points are not finite, or the normal no unit vector: distance ", closest.distance);
    const Vector3 n = closest.normal;
    const Vector3 inB = InverseRotate(bInA.rotation, Vector3(-n));
    const double top = Dot<double>(a.Support(n).cast<double>(), n.cast<double>());
    const double bottom = Dot<double>(
        bInA.position.cast<double>() + Rotate(bInA.rotation, b.Support(inB)).cast<double>(), n.cast<double>());
    const double size = double{a.OuterRadius()} + double{b.OuterRadius()} + double{Length(bInA.position)};
    const double along = bottom - top, tolerance = 1e-3 * size * (closest.distance < 0 ? 1 : 0.1) + FLT_MIN;
    if (std::abs(along - double{closest.distance}) > tolerance)
        return Text("distance ", closest.distance, ", but along the normal it is ", along, ": ",
                    ShapeTypeName(a.Type()), " and ", ShapeTypeName(b.Type()));
    const double between = Dot<double>((closest.onB - closest.onA).cast<double>(), n.cast<double>());
    if (std::abs(between - double{closest.distance}) > tolerance)
        return Text("distance ", closest.distance, ", but its points are ", between,
                    " apart: ", ShapeTypeName(a.Type()), " and ", ShapeTypeName(b.Type()));
    return {};
}

}  // namespace fulcrum::testing
