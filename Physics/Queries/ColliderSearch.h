// Finds the colliders that a query must test: traverses the world's trees and applies the query's filter. Called by
// QueryInterface under the world's lock. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/QueryTypes.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>

namespace fulcrum {

class ColliderSearch {
public:
    ColliderSearch(const WorldState& world, const QueryFilter& filter)
        : world_(world),
          filter_(filter),
          seesAll_(filter.layers == 0xFFFFFFFFu && SeesAllCategories(filter) && filter.ignore.empty() &&
                   !filter.accepts && !filter.acceptsChild) {}

    // Traverses the trees of the filter's layers: walk(tree, visit), where `visit` calls found(collider) for accepted
    // colliders. Colliders outside their fat bounds are tested by their current bounds.
    template <class Walk, class Found>
    void Run(const Walk& walk, const Found& found) const {
        const ColliderStore& store = world_.colliders;
        const CollidersOutsideFatBounds& outsideFatBounds = world_.outsideFatBounds;
        const auto visit = [&](uint32_t collider) {
            if (Accepts(collider)) found(collider);
        };
        const auto walkAll = [&](const auto& visitInTrees) {
            if (filter_.layers & store.movingLayers) walk(store.movingTree, visitInTrees);
            if (filter_.layers & store.staticLayers) walk(store.staticTree, visitInTrees);
            if (filter_.sensors) walk(store.sensorTree, visitInTrees);
        };
        if (outsideFatBounds.IsEmpty()) return walkAll(visit);
        walk(outsideFatBounds.Tree(), [&](uint32_t collider) {
            if (filter_.sensors || !store.colliders[collider].sensor) visit(collider);
        });
        walkAll([&](uint32_t collider) {
            if (!outsideFatBounds.Contains(collider)) visit(collider);
        });
    }

    // Bounds in the trees are relative to this origin.
    const Position& Origin() const { return world_.colliders.boundsOrigin; }
    uint32_t BodyOf(uint32_t collider) const { return world_.colliders.colliders[collider].body; }
    uint32_t ChildOf(uint32_t collider) const { return fulcrum::ChildOf(world_.bodies, world_.colliders, collider); }
    BodyId IdOf(uint32_t collider) const { return world_.bodies.IdOf(BodyOf(collider)); }
    OverlapHit HitOf(uint32_t collider) const { return {IdOf(collider), ChildOf(collider)}; }
    const Shape& ShapeOf(uint32_t collider) const { return *world_.colliders.shapes[collider].shape; }
    Pose PoseOf(uint32_t collider) const {
        const ColliderShape& piece = world_.colliders.shapes[collider];
        const Pose body = world_.seenPoses.ExactPoseOf(world_.lock, world_.bodies, BodyOf(collider));
        return piece.offset ? body * LocalOf(world_.bodies, world_.colliders, collider) : body;
    }
    // Those by which its tree finds it, relative to Origin().
    Bounds BoundsOf(uint32_t collider) const {
        const ColliderStore& store = world_.colliders;
        if (world_.outsideFatBounds.Contains(collider)) return world_.outsideFatBounds.Tree().GetBounds(collider);
        return store.TreeOf(store.colliders[collider]).GetBounds(collider);
    }
    // Tie-breaking order: by body, then child.
    bool ComesBefore(uint32_t a, uint32_t b) const {
        const uint32_t bodyA = BodyOf(a), bodyB = BodyOf(b);
        return bodyA != bodyB ? bodyA < bodyB : ChildOf(a) < ChildOf(b);
    }

private:
    static bool SeesAllCategories(const QueryFilter& filter) {
        return filter.category == 0 && filter.mask == ~uint64_t(0);
    }

    bool AcceptsCategory(const BodyFilter& body) const {
        return (filter_.mask == ~uint64_t(0) || (body.category & filter_.mask)) &&
               (filter_.category == 0 || (filter_.category & body.mask));
    }

    bool Accepts(uint32_t collider) const {
        if (seesAll_) return true;
        const uint32_t body = BodyOf(collider);
        if (!(filter_.layers >> world_.bodies.dynamics[body].layer & 1u)) return false;
        if (!AcceptsCategory(world_.bodies.FilterOf(body))) return false;
        const BodyId id = world_.bodies.IdOf(body);
        for (const BodyId& ignored : filter_.ignore)
            if (ignored == id) return false;
        if (filter_.accepts && !filter_.accepts(id)) return false;
        return !filter_.acceptsChild || filter_.acceptsChild(id, ChildOf(collider));
    }

    const WorldState& world_;
    const QueryFilter& filter_;
    bool seesAll_;
};

// Locks the world for a query and updates its trees. Converts to false if the query is not allowed here, which was
// reported.
class QueryScope {
public:
    explicit QueryScope(WorldState& world) : shared_(world.lock, WorldLock::Access::Queries) {
        if (shared_.Refusal()) {
            ReportMisuse(*shared_.Refusal());
            return;
        }
        world.pendingTrees.Build(world.colliders, *world.jobs);
        world.outsideFatBounds.Refresh(world.bodies, world.colliders);
    }
    explicit operator bool() const { return !shared_.Refusal(); }

private:
    const DefaultFloats floats_;
    WorldLock::Shared shared_;
};

// The pose of a shape's center frame, from the pose of its own frame.
inline Pose CenterPoseOf(const Shape& shape, const Pose& pose) {
    return {pose.Transform(shape.Mass().centerOfMass), pose.rotation};
}

}  // namespace fulcrum
