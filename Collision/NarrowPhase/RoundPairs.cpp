// Pair functions of spheres and capsules among themselves: closest points of points and segments.
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/NarrowPhase/PointsAhead.h>
#include <Fulcrum/Collision/NarrowPhase/Segments.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

namespace fulcrum {

namespace {

constexpr float kFastReach = 2.0f;  // of the smaller radius

// The point between two rounded cores, from the closest points of the cores. `known` (unit) is the normal if `certain`,
// or if the points coincide within rounding.
void BuildPoint(const Vector3& onCoreA, const Vector3& onCoreB, float radiusA, float radiusB, const Vector3& known,
                bool certain, float speculativeDistance, Manifold& manifold) {
    const Vector3 between = onCoreB - onCoreA;
    const float distance = Length(between);
    const float separation = distance - (radiusA + radiusB);
    manifold.pointCount = 0;
    if (separation > speculativeDistance) return;
    const bool useKnown = certain || distance <= 1e-5f * (radiusA + radiusB);
    manifold.normal = useKnown ? known : Vector3(between * (1.0f / distance));
    manifold.pointCount = 1;
    manifold.points[0] = {onCoreA + manifold.normal * radiusA, separation, VertexFeature(true, 0)};
}

Segment CoreSegment(const Capsule& capsule) {
    return {Vector3(0, -capsule.HalfHeight(), 0), Vector3(0, capsule.HalfHeight(), 0)};
}

// Two points along the common length of nearly parallel capsules; false if they have no common length.
bool BuildParallel(const Segment& onA, const Segment& onB, float radiusA, float radiusB, float speculativeDistance,
                   Manifold& manifold) {
    const CommonLength common(onA, onB);
    if (!common.exists) return false;
    const Vector3 middle = onA.At(0.5f * (common.at[0] + common.at[1]));
    const Vector3 between = ClosestOnLine(onB, middle) - middle;
    const float distance = Length(between);
    if (!(distance > 1e-3f * (radiusA + radiusB))) return false;
    manifold.normal = between * (1.0f / distance);
    for (int i = 0; i < 2; ++i) {
        const float separation = common.SeparationAlong(manifold.normal, i) - (radiusA + radiusB);
        if (separation > speculativeDistance) continue;
        manifold.points[manifold.pointCount++] = {common.onP[i] + manifold.normal * radiusA, separation,
                                                  CrossingFeature(0, static_cast<uint32_t>(1 + i))};
    }
    return manifold.pointCount > 0;
}

// For fast capsules, adds points of their ends: a capsule that rotates within the step may hit with an end.
void AddEnds(const Segment& onA, const Segment& onB, float radiusA, float radiusB, float reach, Manifold& manifold) {
    const float smaller = Min(radiusA, radiusB);
    if (reach <= kFastReach * smaller) return;
    constexpr int kEnds = 4;
    ManifoldPoint ends[kEnds];
    int count = 0;
    for (int i = 0; i < kEnds; ++i) {
        const bool isOfA = i < 2;
        const Segment& own = isOfA ? onA : onB;
        const Segment& other = isOfA ? onB : onA;
        const Vector3 end = i % 2 == 0 ? own.from : own.to;
        const Segment point{end, end};
        const Vector3 between = other.At(ClosestOnSegments(point, other).t) - end;  // out of the end
        const float distance = Length(between);
        if (Dot(manifold.normal, isOfA ? between : Vector3(-between)) < kLeastCosineAhead * distance) continue;
        const float separation = distance - (radiusA + radiusB);
        const Vector3 onEnd = end + manifold.normal * (isOfA ? radiusA : -radiusB);
        ends[count++] = {isOfA ? onEnd : Vector3(onEnd - manifold.normal * separation), separation,
                         CrossingFeature(1, static_cast<uint32_t>(i))};
    }
    AddPointsAhead<8>(
        count, [&](int i) { return ends[i]; }, reach, smaller, 0.01f * smaller, {}, manifold);
}

}  // namespace

void CollideSphereSphere(const PairQuery& query, Manifold& manifold) {
    const auto& a = static_cast<const Sphere&>(query.a);
    const auto& b = static_cast<const Sphere&>(query.b);
    BuildPoint(Vector3::Zero(), query.bInA.position, a.Radius(), b.Radius(), Vector3(0, 1, 0), false,
               query.settings.speculativeDistance, manifold);
}

void CollideCapsuleSphere(const PairQuery& query, Manifold& manifold) {
    const auto& a = static_cast<const Capsule&>(query.a);
    const auto& b = static_cast<const Sphere&>(query.b);
    const Vector3 center = query.bInA.position;
    const Vector3 onCore(0, Clamp(center.y(), -a.HalfHeight(), a.HalfHeight()), 0);
    BuildPoint(onCore, center, a.Radius(), b.Radius(), Vector3(1, 0, 0), false, query.settings.speculativeDistance,
               manifold);
}

void CollideCapsuleCapsule(const PairQuery& query, Manifold& manifold) {
    const auto& a = static_cast<const Capsule&>(query.a);
    const auto& b = static_cast<const Capsule&>(query.b);
    const float reach = a.Radius() + b.Radius() + query.settings.speculativeDistance;
    manifold.pointCount = 0;
    const float outer = a.HalfHeight() + b.HalfHeight() + reach;
    if (LengthSquared(query.bInA.position) > outer * outer) return;
    const Vector3 half = Rotate(query.bInA.rotation, Vector3(0, b.HalfHeight(), 0));
    const Segment onA = CoreSegment(a), onB{query.bInA.position - half, query.bInA.position + half};
    const ClosestParameters closest = ClosestOnSegments(onA, onB);
    const Vector3 x = onA.At(closest.s), y = onB.At(closest.t);
    if (LengthSquared(Vector3(y - x)) > reach * reach) return;
    // The normal is perpendicular to both segments if they cross, also if the cores touch.
    const bool parallel = NearlyParallel(onA, onB);
    if (parallel && BuildParallel(onA, onB, a.Radius(), b.Radius(), query.settings.speculativeDistance, manifold))
        return;
    Vector3 crossing = Normalized(Cross<float>(Vector3(0, 1, 0), half), Vector3(1, 0, 0));
    if (Dot(crossing, Vector3(y - x)) < 0.0f) crossing = -crossing;
    const bool cross = !parallel && closest.s > 0 && closest.s < 1 && closest.t > 0 && closest.t < 1;
    BuildPoint(x, y, a.Radius(), b.Radius(), crossing, cross, query.settings.speculativeDistance, manifold);
    if (manifold.pointCount > 0)
        AddEnds(onA, onB, a.Radius(), b.Radius(), query.settings.speculativeDistance, manifold);
}

}  // namespace fulcrum
