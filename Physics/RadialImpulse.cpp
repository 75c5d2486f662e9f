// BodyInterface::AddRadialImpulse: the bodies within a ball about the center, each at its closest point.
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/BodyInterface.h>
#include <Fulcrum/Physics/QueryInterface.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>

namespace fulcrum {

namespace {

struct Closest {
    float distance = 0;  // m; 0: the center is inside
    Position point = Position::Zero();
};

// The point of a body that is closest to the center; none farther than the radius.
std::optional<Closest> ClosestOf(const WorldState& world, uint32_t body, const RadialImpulse& settings) {
    std::optional<Closest> closest;
    VisitColliders(world, body, [&](uint32_t collider) {
        const Pose pose = ColliderPoseOf(world.bodies, world.colliders, collider);
        ClosestPoints found;
        if (!FindClosestPoint(*world.colliders.shapes[collider].shape, pose.InverseTransform(settings.center),
                              settings.radius, found, world.settings.narrowPhase))
            return;
        const float distance = std::max(found.distance, 0.0f);
        if (!closest || distance < closest->distance) closest = {distance, pose.Transform(found.onA)};
    });
    if (closest && closest->distance == 0) closest->point = world.bodies.CenterOf(body);
    return closest;
}

}  // namespace

Result<uint32_t> BodyInterface::AddRadialImpulse(const RadialImpulse& settings, const QueryFilter& filter) {
    const DefaultFloats floats;
    if (MaybeError e = FirstOf(CheckPosition("center", settings.center), CheckPositive("radius", settings.radius),
                               CheckRange("radius", settings.radius, 0, 1e18),
                               CheckRange("impulse", settings.impulse, -1e30, 1e30),
                               CheckEnum("falloff", settings.falloff, RadialImpulse::Falloff::Linear)))
        return *e;
    // Other threads see all of its impulses or none.
    const WorldLock::Exclusive alone(world_.lock, WorldLock::Access::Edits);
    if (alone.Refusal()) return *alone.Refusal();
    std::vector<OverlapHit> hits;
    const Position reach = Position::Constant(double{settings.radius});
    QueryInterface(world_).FindInBox(settings.center - reach, settings.center + reach, hits, filter);
    const auto sameBody = [](const OverlapHit& a, const OverlapHit& b) { return a.body == b.body; };
    hits.erase(std::unique(hits.begin(), hits.end(), sameBody), hits.end());
    uint32_t pushed = 0;
    for (const OverlapHit& hit : hits) {
        if (!world_.bodies.CanMove(hit.body.index)) continue;
        const std::optional<Closest> closest = ClosestOf(world_, hit.body.index, settings);
        if (!closest) continue;
        const Vector3 way = (closest->point - settings.center).cast<float>();
        const bool isLess = settings.falloff == RadialImpulse::Falloff::Linear;
        const float part = isLess ? 1 - closest->distance / settings.radius : 1.0f;
        const float length = Length(way);
        if (!(length > 0) || !(part > 0)) continue;
        if (Status status = AddImpulseAt(hit.body, way * (settings.impulse * part / length), closest->point); !status)
            return status.GetError();
        ++pushed;
    }
    return pushed;
}

}  // namespace fulcrum
