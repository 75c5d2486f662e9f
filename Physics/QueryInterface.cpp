#include <Fulcrum/Physics/QueryInterface.h>

#include <Fulcrum/Collision/Queries/Bearings.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Queries/RaySearch.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/Filters.h>

#include <algorithm>
#include <optional>
#include <tuple>

namespace fulcrum {

namespace {

// bounds: those of the moving shape. No hit is earlier than where it enters the collider's bounds: with shapes of a
// million meters a cast is wrong by decimeters, and would depend on which colliders the tree skips.
WorldShapeHit ToWorld(const ColliderSearch& search, uint32_t collider, const TreeRay& bounds, const ShapeHit& hit) {
    WorldShapeHit result;
    result.body = search.IdOf(collider);
    result.subShape = {search.ChildOf(collider), hit.subShape.triangle};
    result.fraction = std::max(hit.fraction, std::min(bounds.EntryInto(search.BoundsOf(collider)), 1.0f));
    result.normal = hit.normal;
    result.position = hit.position;
    result.depth = hit.depth;
    result.isEarly = hit.isEarly;
    return result;
}

bool IsGiven(const Shape* shape) {
    if (!shape) ReportMisuse({ErrorCode::Unsupported, "the shape of a query is null; it needs one, and found nothing"});
    return shape;
}

bool IsUsable(const Pose& pose) { return IsFinite(pose.position) && IsFinite(pose.rotation); }

// For equal fractions, the deepest first.
template <class Hit>
bool ComesFirst(const Hit& a, const Hit& b) {
    if constexpr (requires { a.depth; }) {
        return std::tuple(a.fraction, -a.depth, a.body, a.subShape) <
               std::tuple(b.fraction, -b.depth, b.body, b.subShape);
    } else {
        return std::tuple(a.fraction, a.body, a.subShape) < std::tuple(b.fraction, b.body, b.subShape);
    }
}

template <class Hit>
void SortHits(std::vector<Hit>& hits) {
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return ComesFirst(a, b); });
}

// Bounds in the trees are relative to this origin.
const Position& OriginOf(const WorldState& world) { return world.colliders.boundsOrigin; }

TreeRay SweptBounds(const WorldState& world, const ShapeCaster& caster, const Pose& pose, const Vector3& displacement,
                    const ShapeCastSettings& settings) {
    const Bounds& bounds = caster.BoundsAboutCenter();
    const Vector3 center = bounds.Center();
    const float slack =
        settings.separation + settings.tolerance + 1e-6f * (bounds.HalfExtents().maxCoeff() + Length(displacement));
    return TreeRay(pose.position - OriginOf(world) + center.cast<double>(), displacement,
                   bounds.HalfExtents() + Vector3::Constant(slack));
}

// What the shape of a cast with ignoreSeparating rests on at the start, for as long as the object lives.
class CastBearings {
public:
    CastBearings(const ColliderSearch& search, const Shape& shape, const Pose& center,
                 const ShapeCastSettings& settings, ShapeCaster& caster) {
        if (!settings.ignoreSeparating) return;
        Bearings& bearings = bearings_.emplace();
        const Bounds bounds = Inflated(BoundsAbout(search.Origin(), shape, center), caster.ReachOfBearings(settings));
        search.Run([&](const BoundsTree& tree, const auto& found) { tree.Query(bounds, found); },
                   [&](uint32_t collider) {
                       caster.FindBearings(search.ShapeOf(collider), search.PoseOf(collider), settings, bearings);
                   });
        bearings.Merge();
        caster.RestOn(bearings);
    }

private:
    std::optional<Bearings> bearings_;
};

Bounds TreeBounds(const WorldState& world, const Position& lower, const Position& upper) {
    return RoundedOutwards(lower - OriginOf(world), upper - OriginOf(world));
}

}  // namespace

WorldLock::Shared QueryInterface::Hold(HoldFor purpose) const {
    const WorldLock::Access access =
        purpose == HoldFor::Queries ? WorldLock::Access::Queries : WorldLock::Access::Reads;
    const std::optional<Error> refusal = WorldLock::RefusalOfReading(world_.lock, access);
    if (refusal) ReportMisuse(*refusal);
    else (void)IsReadable(world_);
    return WorldLock::Shared(world_.lock, access);
}

// ---- Rays

bool QueryInterface::CastRay(const Ray& ray, WorldRayHit& hit, const RayCastSettings& settings,
                             const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope) return false;
    return CastClosest(ColliderSearch(world_, filter), ray, settings, hit);
}

bool QueryInterface::IsHit(const Ray& ray, const RayCastSettings& settings, const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope) return false;
    const RayCaster caster(ray);
    if (!caster.IsValid()) return false;
    const ColliderSearch search(world_, filter);
    float limit = settings.maxFraction;
    bool hit = false;
    AlongRay(search, TreeRay(ray.origin - OriginOf(world_), ray.displacement), limit, [&](uint32_t collider) {
        if (hit || !caster.IsHit(search.ShapeOf(collider), search.PoseOf(collider), settings)) return;
        hit = true;
        limit = -1;
    });
    return hit;
}

void QueryInterface::VisitRay(const Ray& ray, FunctionRef<float(const WorldRayHit&)> visit,
                              const RayCastSettings& settings, const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope) return;
    const RayCaster caster(ray);
    if (!caster.IsValid()) return;
    const ColliderSearch search(world_, filter);
    RayCastSettings upTo = settings;
    AlongRay(search, TreeRay(ray.origin - OriginOf(world_), ray.displacement), upTo.maxFraction,
             [&](uint32_t collider) {
                 if (upTo.maxFraction < 0) return;
                 caster.CastAll(search.ShapeOf(collider), search.PoseOf(collider), upTo, [&](const RayHit& found) {
                     if (found.fraction > upTo.maxFraction) return true;
                     upTo.maxFraction = std::min(upTo.maxFraction, visit(ToWorld(search, collider, ray, found)));
                     return upTo.maxFraction >= 0;
                 });
             });
}

void QueryInterface::CastRayAll(const Ray& ray, std::vector<WorldRayHit>& hits, const RayCastSettings& settings,
                                const QueryFilter& filter) const {
    const DefaultFloats floats;
    hits.clear();
    VisitRay(
        ray, [&](const WorldRayHit& hit) { return hits.push_back(hit), settings.maxFraction; }, settings, filter);
    SortHits(hits);
}

// ---- Moving shapes

void QueryInterface::VisitShape(const MovingShape& shape, FunctionRef<float(const WorldShapeHit&)> visit,
                                const ShapeCastSettings& settings, const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope || !IsGiven(shape.shape)) return;
    const ShapeMotion motion{CenterPoseOf(*shape.shape, shape.pose), shape.displacement, shape.turn};
    ShapeCaster caster(*shape.shape, motion, world_.settings.narrowPhase);
    if (!caster.IsValid() || !settings.IsValid()) return;
    const ColliderSearch search(world_, filter);
    const CastBearings bearings(search, *shape.shape, motion.pose, settings, caster);
    ShapeCastSettings upTo = settings;
    const TreeRay bounds = SweptBounds(world_, caster, motion.pose, shape.displacement, settings);
    AlongRay(search, bounds, upTo.maxFraction, [&](uint32_t collider) {
        if (upTo.maxFraction < 0) return;
        caster.CastAll(search.ShapeOf(collider), search.PoseOf(collider), upTo, [&](const ShapeHit& found) {
            const WorldShapeHit here = ToWorld(search, collider, bounds, found);
            if (here.fraction > upTo.maxFraction) return true;
            upTo.maxFraction = std::min(upTo.maxFraction, visit(here));
            return upTo.maxFraction >= 0;
        });
    });
}

bool QueryInterface::CastShape(const MovingShape& shape, WorldShapeHit& hit, const ShapeCastSettings& settings,
                               const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope || !IsGiven(shape.shape)) return false;
    const ShapeMotion motion{CenterPoseOf(*shape.shape, shape.pose), shape.displacement, shape.turn};
    ShapeCaster caster(*shape.shape, motion, world_.settings.narrowPhase);
    if (!caster.IsValid() || !settings.IsValid()) return false;
    const ColliderSearch search(world_, filter);
    const CastBearings bearings(search, *shape.shape, motion.pose, settings, caster);
    ShapeCastSettings upTo = settings;
    bool any = false;
    const TreeRay bounds = SweptBounds(world_, caster, motion.pose, shape.displacement, settings);
    AlongRay(search, bounds, upTo.maxFraction, [&](uint32_t collider) {
        ShapeHit found;
        if (!caster.CastClosest(search.ShapeOf(collider), search.PoseOf(collider), upTo, found)) return;
        const WorldShapeHit here = ToWorld(search, collider, bounds, found);
        if (here.fraction > upTo.maxFraction || (any && !ComesFirst(here, hit))) return;
        any = true;
        hit = here;
        upTo.maxFraction = here.fraction;
    });
    return any;
}

bool QueryInterface::IsHit(const MovingShape& shape, const ShapeCastSettings& settings,
                           const QueryFilter& filter) const {
    bool hit = false;
    VisitShape(
        shape, [&](const WorldShapeHit&) { return hit = true, -1.0f; }, settings, filter);
    return hit;
}

void QueryInterface::CastShapeAll(const MovingShape& shape, std::vector<WorldShapeHit>& hits,
                                  const ShapeCastSettings& settings, const QueryFilter& filter) const {
    const DefaultFloats floats;
    hits.clear();
    VisitShape(
        shape, [&](const WorldShapeHit& hit) { return hits.push_back(hit), settings.maxFraction; }, settings, filter);
    SortHits(hits);
}

// ---- Overlaps

void QueryInterface::VisitOverlaps(const PlacedShape& shape, FunctionRef<bool(const OverlapHit&)> visit,
                                   const QueryFilter& filter) const {
    const QueryScope scope(world_);
    if (!scope || !IsGiven(shape.shape)) return;
    const Pose pose = CenterPoseOf(*shape.shape, shape.pose);
    if (!IsUsable(pose)) return;
    const ColliderSearch search(world_, filter);
    const Bounds bounds = BoundsAbout(OriginOf(world_), *shape.shape, pose);
    bool goOn = true;
    search.Run([&](const BoundsTree& tree, const auto& found) { tree.Query(bounds, found); },
               [&](uint32_t collider) {
                   if (!goOn) return;
                   const RelativePose relative = Relative(search.PoseOf(collider), pose);
                   if (Overlap(search.ShapeOf(collider), *shape.shape, relative, world_.settings.narrowPhase))
                       goOn = visit(search.HitOf(collider));
               });
}

bool QueryInterface::IsOverlapping(const PlacedShape& shape, const QueryFilter& filter) const {
    bool overlaps = false;
    VisitOverlaps(
        shape, [&](const OverlapHit&) { return overlaps = true, false; }, filter);
    return overlaps;
}

void QueryInterface::FindOverlaps(const PlacedShape& shape, std::vector<OverlapHit>& hits,
                                  const QueryFilter& filter) const {
    hits.clear();
    VisitOverlaps(
        shape, [&](const OverlapHit& hit) { return hits.push_back(hit), true; }, filter);
    std::sort(hits.begin(), hits.end());
}

void QueryInterface::FindBodiesAt(const Position& point, std::vector<OverlapHit>& hits,
                                  const QueryFilter& filter) const {
    const DefaultFloats floats;
    hits.clear();
    if (!IsFinite(point)) return;
    const QueryScope scope(world_);
    if (!scope) return;
    const ColliderSearch search(world_, filter);
    const Bounds bounds = TreeBounds(world_, point, point);
    search.Run([&](const BoundsTree& tree, const auto& found) { tree.Query(bounds, found); },
               [&](uint32_t collider) {
                   if (Contains(search.ShapeOf(collider), search.PoseOf(collider).InverseTransform(point),
                                world_.settings.narrowPhase))
                       hits.push_back(search.HitOf(collider));
               });
    std::sort(hits.begin(), hits.end());
}

// ---- Closest

bool QueryInterface::FindClosest(const PlacedShape& shape, float maxDistance, WorldClosest& closest,
                                 const QueryFilter& filter) const {
    const DefaultFloats floats;
    const QueryScope scope(world_);
    if (!scope || !IsGiven(shape.shape)) return false;
    const Pose pose = CenterPoseOf(*shape.shape, shape.pose);
    if (!IsUsable(pose) || !(maxDistance >= 0)) return false;
    const ColliderSearch search(world_, filter);
    const Bounds bounds = BoundsAbout(OriginOf(world_), *shape.shape, pose);
    // Bodies are also tested a little beyond the best distance, by what distances are off due to rounding: the answer
    // does not depend on the order in which the tree finds them.
    const float rounding = RoundingOfDistances(shape.shape->OuterRadius());
    float reach = maxDistance + rounding;
    uint32_t bestCollider = ~0u;
    ClosestPoints best;
    search.Run([&](const BoundsTree& tree, const auto& found) { tree.VisitNear(bounds, reach, found); },
               [&](uint32_t collider) {
                   ClosestPoints found;
                   const Pose at = search.PoseOf(collider);
                   const Shape& candidate = search.ShapeOf(collider);
                   const float reachOfPair = reach + RoundingOfDistances(candidate.OuterRadius());
                   if (!FindClosestPoints(candidate, *shape.shape, Relative(at, pose), reachOfPair, found,
                                          world_.settings.narrowPhase) ||
                       found.distance > maxDistance)
                       return;
                   const bool isCloser =
                       bestCollider == ~0u || found.distance < best.distance ||
                       (found.distance == best.distance && search.ComesBefore(collider, bestCollider));
                   if (!isCloser) return;
                   best = found;
                   bestCollider = collider;
                   reach = std::max(best.distance, 0.0f) + rounding;  // overlapping ones are all tested for the deepest
               });
    if (bestCollider == ~0u) return false;
    const Pose at = search.PoseOf(bestCollider);
    closest.body = search.IdOf(bestCollider);
    closest.subShape = {search.ChildOf(bestCollider), best.subShapeOfA.triangle};
    closest.subShapeOfQuery = best.subShapeOfB;
    closest.distance = best.distance;
    closest.normal = Rotate(at.rotation, best.normal);
    closest.onBody = at.Transform(best.onA);
    closest.onQuery = at.Transform(best.onB);
    return true;
}

bool QueryInterface::FindClosest(const Position& point, float maxDistance, WorldClosest& closest,
                                 const QueryFilter& filter) const {
    const DefaultFloats floats;
    const PointCore core;
    return FindClosest(PlacedShape{&core, {point, {}}}, maxDistance, closest, filter);
}

// ---- Bounds

void QueryInterface::FindInBox(const Position& lower, const Position& upper, std::vector<OverlapHit>& hits,
                               const QueryFilter& filter) const {
    const DefaultFloats floats;
    hits.clear();
    if (!IsFinite(lower) || !IsFinite(upper)) return;
    const QueryScope scope(world_);
    if (!scope) return;
    const ColliderSearch search(world_, filter);
    const Bounds bounds = TreeBounds(world_, lower, upper);
    search.Run([&](const BoundsTree& tree, const auto& found) { tree.Query(bounds, found); },
               [&](uint32_t collider) { hits.push_back(search.HitOf(collider)); });
    std::sort(hits.begin(), hits.end());
}

bool QueryInterface::MayCollide(BodyId a, BodyId b) const {
    const QueryScope scope(world_);
    const BodyStore& bodies = world_.bodies;
    if (!bodies.Find(a) || !bodies.Find(b) || bodies.cold[a.index].isSensor || bodies.cold[b.index].isSensor)
        return false;
    return CanCollide(world_.settings, world_.bodies, world_.joints, a.index, b.index);
}

void QueryInterface::FindOnSweep(const Position& lower, const Position& upper, const Vector3& displacement,
                                 std::vector<OverlapHit>& hits, const QueryFilter& filter) const {
    const DefaultFloats floats;
    hits.clear();
    if (!IsFinite(lower) || !IsFinite(upper) || !IsFinite(displacement) || !lower.isAtMost(upper)) return;
    const QueryScope scope(world_);
    if (!scope) return;
    const ColliderSearch search(world_, filter);
    const Position half = (upper - lower) * 0.5;
    const Vector3 halfExtents(RoundUp(half.x()), RoundUp(half.y()), RoundUp(half.z()));
    float limit = 1;
    AlongRay(search, TreeRay(lower - OriginOf(world_) + half, displacement, halfExtents), limit,
             [&](uint32_t collider) { hits.push_back(search.HitOf(collider)); });
    std::sort(hits.begin(), hits.end());
}

void QueryInterface::FindOnRay(const Ray& ray, std::vector<OverlapHit>& hits, const QueryFilter& filter) const {
    const DefaultFloats floats;
    FindOnSweep(ray.origin, ray.origin, ray.displacement, hits, filter);
}

}  // namespace fulcrum
