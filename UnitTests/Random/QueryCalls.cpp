#include <Fulcrum/UnitTests/Random/Calls.h>
#include <Fulcrum/UnitTests/Random/QueryChecks.h>
#include <Fulcrum/UnitTests/Random/RandomShapes.h>

namespace fulcrum::testing {

namespace {

void Fail(Outcome& outcome, std::string what) {
    if (outcome.failure.empty()) outcome.failure = std::move(what);
}

// The target of a query: mostly one of the call's bodies.
Position Aim(const Twin& twin, Values& values, const CallTargets& targets) {
    const BodyInterface& bodies = twin.system->Bodies();
    const BodyId id = twin.bodies[values.Chance(0.5f) ? targets.bodyA : targets.bodyB];
    const Vector3 jitter = values.Random().InBox(0.5f);
    if (!bodies.Exists(id) || values.Chance(0.2f)) return values.Place(2);
    return bodies.GetPose(id).position + jitter.cast<double>();
}

Ray RandomRay(const Twin& twin, Values& values, const CallTargets& targets) {
    const Position at = Aim(twin, values, targets);
    const Vector3 way = values.Random().InBox(4);
    const Position origin = at - way.cast<double>() * double{values.Between(0, 1.2f)};
    Ray ray{origin, way};
    if (values.Chance(0.2f)) ray.displacement[static_cast<int>(values.Below(3))] = 0;
    if (values.IsOdd()) ray.origin = values.Place(5);
    if (values.IsOdd()) ray.displacement = values.Offset(5);
    return ray;
}

RayCastSettings RandomRaySettings(Values& values) {
    RayCastSettings settings{.backFaces = values.Chance(0.3f), .hollow = values.Chance(0.3f)};
    if (values.Chance(0.3f)) settings.maxFraction = values.Number(0, 1, true);
    return settings;
}

void AddHit(const WorldRayHit& hit, BitHash& answer) {
    answer.Add(hit.body);
    answer.Add(hit.subShape);
    answer.Add(hit.fraction);
    answer.Add(hit.normal);
}

std::string ListsText(const Ray& ray, const WorldRayHit& single, const std::vector<WorldRayHit>& alone,
                      const std::vector<WorldRayHit>& inBatch) {
    std::string text =
        Text(": ray from ", ray.origin, " by ", ray.displacement, ", closest", ToText(single), ", alone");
    for (const WorldRayHit& hit : alone) text += ToText(hit);
    text += ", in a batch";
    for (const WorldRayHit& hit : inBatch) text += ToText(hit);
    return text;
}

// Single casts, batches, all hits and any hit must agree, also with tests of every single body.
void CastRays(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    std::vector<Ray> rays;
    const uint32_t count = 1 + values.Below(40);
    const bool together = values.Chance(0.5f);
    const Ray first = RandomRay(twin, values, targets);
    for (uint32_t i = 0; i < count; ++i) {
        Ray ray = together ? first : RandomRay(twin, values, targets);
        if (together) ray.origin += values.Random().InBox(0.05f).cast<double>();
        if (together && values.IsOdd()) ray.displacement[static_cast<int>(values.Below(3))] = values.Extreme();
        rays.push_back(ray);
    }
    const RayCastSettings settings = values.Chance(0.5f) ? RayCastSettings{} : RandomRaySettings(values);
    const bool isPlain = settings.maxFraction == 1 && !settings.backFaces && !settings.hollow;
    std::vector<WorldRayHit> hits(count);
    std::vector<uint8_t> any(count);
    std::vector<std::vector<WorldRayHit>> all;
    queries.CastRays(rays, hits, settings);
    queries.AreHit(std::span<const Ray>(rays), any, settings);
    queries.CastRaysAll(rays, all, settings);
    const std::vector<BodyShape> bodies = ShapesOf(*twin.system);
    for (uint32_t i = 0; i < count; ++i) {
        WorldRayHit single;
        std::vector<WorldRayHit> singleAll;
        const bool isHit = queries.CastRay(rays[i], single, settings);
        queries.CastRayAll(rays[i], singleAll, settings);
        if (isHit != (single.body != BodyId{}) || !AreSame(single, hits[i]))
            Fail(outcome, "a ray of a batch differs from the ray alone" + ToText(single) + ToText(hits[i]));
        if (isHit != (any[i] != 0) || isHit != queries.IsHit(rays[i], settings))
            Fail(outcome, "whether a ray hits anything differs from its hit");
        if (isHit == singleAll.empty() || singleAll.size() != all[i].size())
            Fail(outcome, "the list of all hits differs" + ListsText(rays[i], single, singleAll, all[i]));
        if (isPlain) Fail(outcome, CompareRay(bodies, rays[i], single));
        AddHit(single, outcome.answer);
    }
}

MovingShape RandomMotion(const Twin& twin, Values& values, const CallTargets& targets, const ConvexShape& shape) {
    const Ray way = RandomRay(twin, values, targets);
    MovingShape moving{&shape, {way.origin, values.Rotation()}, way.displacement};
    if (values.Chance(0.4f)) moving.turn = values.Offset(2);
    return moving;
}

void CastShapes(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    const ShapePtr shape = RandomConvex(values);
    if (!shape) return;
    std::vector<MovingShape> shapes;
    const uint32_t count = 1 + values.Below(6);
    for (uint32_t i = 0; i < count; ++i)
        shapes.push_back(RandomMotion(twin, values, targets, static_cast<const ConvexShape&>(*shape)));
    ShapeCastSettings settings;
    const bool isPlain = values.Chance(0.6f);
    if (!isPlain) {
        settings.backFaces = values.Chance(0.5f);
        if (values.Chance(0.5f)) settings.maxFraction = values.Number(0, 1, true);
        if (values.Chance(0.5f)) settings.separation = values.Number(0, 0.1f, true);
        if (values.Chance(0.5f)) settings.tolerance = values.Number(0, 0.1f, true);
    }
    std::vector<WorldShapeHit> hits(count);
    std::vector<uint8_t> any(count);
    queries.CastShapes(shapes, hits, settings);
    queries.AreHit(std::span<const MovingShape>(shapes), any, settings);
    const std::vector<BodyShape> bodies = ShapesOf(*twin.system);
    for (uint32_t i = 0; i < count; ++i) {
        WorldShapeHit single;
        const bool isHit = queries.CastShape(shapes[i], single, settings);
        if (isHit != (single.body != BodyId{}) || !AreSame(single, hits[i]))
            Fail(outcome, "a shape of a batch differs from the shape alone" + ToText(single) + ToText(hits[i]));
        if (isHit != (any[i] != 0) || isHit != queries.IsHit(shapes[i], settings))
            Fail(outcome, "whether a shape hits anything differs from its hit");
        if (isPlain) Fail(outcome, CheckShapeHit(bodies, shapes[i], single));
        outcome.answer.Add(single.body);
        outcome.answer.Add(single.fraction);
        outcome.answer.Add(single.normal);
    }
}

void FindOverlaps(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    const ShapePtr shape = RandomShape(values);
    if (!shape) return;
    const PlacedShape placed{shape.get(), {Aim(twin, values, targets), values.Rotation()}};
    std::vector<OverlapHit> hits;
    queries.FindOverlaps(placed, hits);
    if (queries.IsOverlapping(placed) == hits.empty())
        Fail(outcome, "whether a shape overlaps anything differs from the list");
    for (const OverlapHit& hit : hits) outcome.answer.Add(hit.body);
    std::vector<OverlapHit> others;
    const BodyId ignored[] = {twin.bodies[targets.bodyA]};
    queries.FindOverlaps(placed, others, {.ignore = ignored});
    std::erase_if(hits, [&](const OverlapHit& hit) { return hit.body == ignored[0]; });
    if (hits != others) Fail(outcome, "a body that is ignored changes what else overlaps");
}

void CollideShape(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const ShapePtr shape = RandomConvex(values);
    if (!shape) return;
    const PlacedShape placed{shape.get(), {Aim(twin, values, targets), values.Rotation()}};
    const float most = values.Chance(0.5f) ? 0 : values.Number(0, 1, true);
    std::vector<WorldContact> contacts;
    twin.system->Queries().CollideShape(placed, most, contacts);
    for (const WorldContact& contact : contacts) {
        outcome.answer.Add(contact.body);
        if (contact.pointCount < 1 || contact.pointCount > 4 || !(std::fabs(Length(contact.normal) - 1) < 1e-3f))
            Fail(outcome, "a contact without points, or whose normal is no direction");
        for (const WorldContact::Point& point : contact.Points()) {
            outcome.answer.Add(point.separation);
            if (!(point.separation <= most)) Fail(outcome, "a contact point is farther apart than was asked for");
        }
    }
}

void FindClosest(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    const ShapePtr shape = RandomShape(values);
    if (!shape) return;
    std::vector<PlacedShape> shapes;
    for (uint32_t i = 0; i < 3; ++i) shapes.push_back({shape.get(), {Aim(twin, values, targets), values.Rotation()}});
    const float maxDistance = values.Chance(0.3f) ? std::numeric_limits<float>::infinity() : values.Number(0, 5, true);
    std::vector<WorldClosest> closest(shapes.size());
    queries.FindClosest(std::span<const PlacedShape>(shapes), maxDistance, closest);
    const std::vector<BodyShape> bodies = ShapesOf(*twin.system);
    for (size_t i = 0; i < shapes.size(); ++i) {
        WorldClosest single;
        const bool isFound = queries.FindClosest(shapes[i], maxDistance, single);
        if (isFound != (single.body != BodyId{}) || !AreSame(single, closest[i]))
            Fail(outcome, "the closest of a batch differs from that alone" + ToText(single) + ToText(closest[i]));
        if (IsFinite(shapes[i].pose.rotation) && IsFinite(shapes[i].pose.position))
            Fail(outcome, CompareClosest(bodies, shapes[i], maxDistance, single));
        outcome.answer.Add(single.body);
        outcome.answer.Add(single.distance);
    }
}

void FindByPoint(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    const Position point = values.IsOdd() ? values.Place(3) : Aim(twin, values, targets);
    std::vector<OverlapHit> hits;
    queries.FindBodiesAt(point, hits);
    for (const OverlapHit& hit : hits) outcome.answer.Add(hit.body);
    WorldClosest closest;
    if (queries.FindClosest(point, values.Number(0, 5, true), closest)) outcome.answer.Add(closest.body);
    Fail(outcome, CheckClosestInside(ShapesOf(*twin.system), hits, point, closest));
}

void FindByBounds(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const QueryInterface& queries = twin.system->Queries();
    const Position center = Aim(twin, values, targets);
    const double z = double{values.Size()}, y = double{values.Size()}, x = double{values.Size()};
    const Position half(x, y, z);
    std::vector<OverlapHit> hits, onRay, onSweep;
    queries.FindInBox(center - half, center + half, hits);
    queries.FindOnRay(RandomRay(twin, values, targets), onRay);
    queries.FindOnSweep(center - half, center + half, values.Offset(3), onSweep);
    for (const std::vector<OverlapHit>& list : {hits, onRay, onSweep})
        for (const OverlapHit& hit : list) outcome.answer.Add(hit.body);
}

void AskAboutNothing(Twin& twin, Values& values, const CallTargets&, Outcome& outcome) {
    if (!values.Style().nullShapes) return;
    const QueryInterface& queries = twin.system->Queries();
    std::vector<OverlapHit> overlaps;
    WorldShapeHit hit;
    WorldClosest closest;
    queries.FindOverlaps(PlacedShape{}, overlaps);
    const bool found = queries.CastShape(MovingShape{}, hit) || queries.IsHit(MovingShape{}) ||
                       queries.IsOverlapping(PlacedShape{}) || queries.FindClosest(PlacedShape{}, 1, closest);
    if (found || !overlaps.empty()) Fail(outcome, "no shape at all is found somewhere");
}

constexpr CallKind kCalls[] = {
    {"CastRays", 5, CastRays},         {"CastShapes", 4, CastShapes},
    {"FindOverlaps", 3, FindOverlaps}, {"CollideShape", 2, CollideShape},
    {"FindClosest", 3, FindClosest},   {"FindByPoint", 1, FindByPoint},
    {"FindByBounds", 1, FindByBounds}, {"AskAboutNothing", 0.3f, AskAboutNothing},
};

}  // namespace

std::span<const CallKind> QueryCalls() { return kCalls; }

}  // namespace fulcrum::testing
