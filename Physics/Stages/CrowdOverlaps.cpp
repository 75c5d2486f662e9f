#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>
#include <array>

namespace fulcrum {

namespace {

Position ColliderCenterOf(const WorldState& world, uint32_t collider) {
    const uint32_t body = world.colliders.colliders[collider].body;
    const Position center = world.bodies.CenterOf(body);
    if (!world.colliders.shapes[collider].offset) return center;
    return center + Rotate(world.bodies.RotationOf(body), LocalOf(world, collider).position).cast<double>();
}

bool AreDynamic(const WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    const auto isDynamic = [&](uint32_t index) {
        return world.bodies.dynamics[world.colliders.colliders[index].body].motion == MotionType::Dynamic;
    };
    return isDynamic(colliderA) && isDynamic(colliderB);
}

// m^2
float SquaredDistance(const WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    return LengthSquared(
        Vector3((ColliderCenterOf(world, colliderB) - ColliderCenterOf(world, colliderA)).cast<float>()));
}

// Whether two colliders belong to dynamic bodies, whose shapes are convex, and overlap.
bool ShapesOverlap(const WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    if (!AreDynamic(world, colliderA, colliderB)) return false;
    const ConvexShape& a = static_cast<const ConvexShape&>(*world.colliders.shapes[colliderA].shape);
    const ConvexShape& b = static_cast<const ConvexShape&>(*world.colliders.shapes[colliderB].shape);
    const float square = SquaredDistance(world, colliderA, colliderB);
    const float inner = a.InnerRadius() + b.InnerRadius(), outer = a.OuterRadius() + b.OuterRadius();
    if (square < inner * inner || square >= outer * outer) return square < inner * inner;
    Manifold manifold;
    PairCache cache;
    CollideCounters counters;
    Collide(a, b, Relative(ColliderPoseOf(world, colliderA), ColliderPoseOf(world, colliderB)),
            {.method = world.settings.narrowPhase}, cache, manifold, counters);
    return std::any_of(manifold.points, manifold.points + manifold.pointCount,
                       [](const ManifoldPoint& point) { return point.separation < 0; });
}

bool OverlapDispersingDeeply(const WorldState& world, uint32_t collider, uint32_t other) {
    return world.bodies.dynamics[world.colliders.colliders[other].body].dispersing &&
           OverlapDeeply(world, collider, other);
}

// Whether overlap(world, collider of the body, collider of another) is true for at least kCount other bodies.
template <size_t kCount, class Test>
bool OverlapsAtLeast(const WorldState& world, const JointedGroups& groups, uint32_t body, const Test& overlap) {
    std::array<uint32_t, kCount> others;
    size_t count = 0;
    const auto counts = [&](uint32_t collider, uint32_t index) {
        const uint32_t other = world.colliders.colliders[index].body;
        if (!overlap(world, collider, index) || groups.RootOf(other) == groups.RootOf(body)) return false;
        if (std::find(others.data(), others.data() + count, other) != others.data() + count) return false;
        return CanCollide(world, body, other) &&
               (world.pairs.Find(collider, index) != PairStore::kNone || ListenerAllows(world, body, other));
    };
    VisitColliders(world, body, [&](uint32_t collider) {
        float distance = 0;  // below zero ends the search
        if (count == kCount) return;
        world.colliders.movingTree.VisitNear(TightBoundsOf(world, collider), distance, [&](uint32_t index) {
            if (counts(collider, index)) others[count++] = world.colliders.colliders[index].body;
            if (count == kCount) distance = -1;
        });
    });
    return count == kCount;
}

}  // namespace

JointedGroups::JointedGroups(const WorldState& world, ScratchArena& scratch) {
    if (world.joints.Count() == 0) return;
    roots_ = scratch.Allocate<uint32_t>(world.bodies.Size());
    UnionFind sets(roots_);
    for (const Joint& joint : world.joints.joints)
        if (joint.exists && joint.enabled && !joint.still[0] && !joint.still[1])
            sets.Unite(joint.body[0], joint.body[1]);
    for (uint32_t body = 0; body < roots_.size(); ++body) roots_[body] = sets.Find(body);
}

bool OverlapDeeply(const WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    if (!AreDynamic(world, colliderA, colliderB)) return false;
    const float reach =
        DeepOverlapDistance(*world.colliders.shapes[colliderA].shape, *world.colliders.shapes[colliderB].shape);
    return SquaredDistance(world, colliderA, colliderB) < reach * reach;
}

bool OverlapsAnother(const WorldState& world, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<1>(world, groups, body, ShapesOverlap);
}

bool OverlapsMany(const WorldState& world, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<kManyOverlaps>(world, groups, body, ShapesOverlap);
}

bool OverlapsManyDeeply(const WorldState& world, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<kManyOverlaps>(world, groups, body, OverlapDeeply);
}

bool OverlapsDispersingDeeply(const WorldState& world, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<1>(world, groups, body, OverlapDispersingDeeply);
}

}  // namespace fulcrum
