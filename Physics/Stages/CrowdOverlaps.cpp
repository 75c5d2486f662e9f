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

Position ColliderCenterOf(const CollisionView& view, uint32_t collider) {
    const uint32_t body = view.colliders.colliders[collider].body;
    const Position center = view.bodies.CenterOf(body);
    if (!view.colliders.shapes[collider].offset) return center;
    return center +
           Rotate(view.bodies.RotationOf(body), LocalOf(view.bodies, view.colliders, collider).position).cast<double>();
}

bool AreDynamic(const CollisionView& view, uint32_t colliderA, uint32_t colliderB) {
    const auto isDynamic = [&](uint32_t index) {
        return view.bodies.dynamics[view.colliders.colliders[index].body].motion == MotionType::Dynamic;
    };
    return isDynamic(colliderA) && isDynamic(colliderB);
}

// m^2
float SquaredDistance(const CollisionView& view, uint32_t colliderA, uint32_t colliderB) {
    return LengthSquared(
        Vector3((ColliderCenterOf(view, colliderB) - ColliderCenterOf(view, colliderA)).cast<float>()));
}

// Whether two colliders belong to dynamic bodies, whose shapes are convex, and overlap.
bool ShapesOverlap(const CollisionView& view, uint32_t colliderA, uint32_t colliderB) {
    if (!AreDynamic(view, colliderA, colliderB)) return false;
    const ConvexShape& a = static_cast<const ConvexShape&>(*view.colliders.shapes[colliderA].shape);
    const ConvexShape& b = static_cast<const ConvexShape&>(*view.colliders.shapes[colliderB].shape);
    const float square = SquaredDistance(view, colliderA, colliderB);
    const float inner = a.InnerRadius() + b.InnerRadius(), outer = a.OuterRadius() + b.OuterRadius();
    if (square < inner * inner || square >= outer * outer) return square < inner * inner;
    Manifold manifold;
    PairCache cache;
    CollideCounters counters;
    Collide(a, b,
            Relative(ColliderPoseOf(view.bodies, view.colliders, colliderA),
                     ColliderPoseOf(view.bodies, view.colliders, colliderB)),
            {.method = view.step.settings.narrowPhase}, cache, manifold, counters);
    return std::any_of(manifold.points, manifold.points + manifold.pointCount,
                       [](const ManifoldPoint& point) { return point.separation < 0; });
}

bool OverlapDispersingDeeply(const CollisionView& view, uint32_t collider, uint32_t other) {
    return view.bodies.dynamics[view.colliders.colliders[other].body].dispersing &&
           OverlapDeeply(view, collider, other);
}

// Whether overlap(view, collider of the body, collider of another) is true for at least kCount other bodies.
template <size_t kCount, class Test>
bool OverlapsAtLeast(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body,
                     const Test& overlap) {
    std::array<uint32_t, kCount> others;
    size_t count = 0;
    const auto counts = [&](uint32_t collider, uint32_t index) {
        const uint32_t other = view.colliders.colliders[index].body;
        if (!overlap(view, collider, index) || groups.RootOf(other) == groups.RootOf(body)) return false;
        if (std::find(others.data(), others.data() + count, other) != others.data() + count) return false;
        return CanCollide(view, body, other) &&
               (pairs.Find(collider, index) != PairStore::kNone || ListenerAllows(view, body, other));
    };
    VisitColliders(view.bodies, view.colliders, body, [&](uint32_t collider) {
        float distance = 0;  // negative ends the search
        if (count == kCount) return;
        view.colliders.movingTree.VisitNear(TightBoundsOf(view.bodies, view.colliders, collider), distance,
                                            [&](uint32_t index) {
                                                if (counts(collider, index))
                                                    others[count++] = view.colliders.colliders[index].body;
                                                if (count == kCount) distance = -1;
                                            });
    });
    return count == kCount;
}

}  // namespace

JointedGroups::JointedGroups(uint32_t bodyCount, const JointStore& joints, ScratchArena& scratch) {
    if (joints.Count() == 0) return;
    roots_ = scratch.Allocate<uint32_t>(bodyCount);
    UnionFind sets(roots_);
    for (const Joint& joint : joints.joints)
        if (joint.exists && joint.enabled && !joint.fixed[0] && !joint.fixed[1])
            sets.Unite(joint.body[0], joint.body[1]);
    for (uint32_t body = 0; body < roots_.size(); ++body) roots_[body] = sets.Find(body);
}

bool OverlapDeeply(const CollisionView& view, uint32_t colliderA, uint32_t colliderB) {
    if (!AreDynamic(view, colliderA, colliderB)) return false;
    const float reach =
        DeepOverlapDistance(*view.colliders.shapes[colliderA].shape, *view.colliders.shapes[colliderB].shape);
    return SquaredDistance(view, colliderA, colliderB) < reach * reach;
}

bool OverlapsAnother(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<1>(view, pairs, groups, body, ShapesOverlap);
}

bool OverlapsMany(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<kManyOverlaps>(view, pairs, groups, body, ShapesOverlap);
}

bool OverlapsManyDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body) {
    return OverlapsAtLeast<kManyOverlaps>(view, pairs, groups, body, OverlapDeeply);
}

bool OverlapsDispersingDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups,
                              uint32_t body) {
    return OverlapsAtLeast<1>(view, pairs, groups, body, OverlapDispersingDeeply);
}

}  // namespace fulcrum
