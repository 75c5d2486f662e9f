#include <Fulcrum/Physics/World/Sleeping.h>

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Reservations.h>
#include <Fulcrum/Physics/World/ReserveMore.h>
#include <Fulcrum/Physics/World/UnionFind.h>

namespace fulcrum {

namespace {

// Bodies that fall asleep outside their fat bounds, because they were fast or the step long, would otherwise not be
// found until they wake.
void RefitFatBounds(const SleepStores& stores, CollidersOutsideFatBounds& outsideFatBounds, uint32_t body) {
    ColliderStore& colliders = stores.colliders;
    VisitColliders(stores.bodies, colliders, body, [&](uint32_t i) {
        Collider& collider = colliders.colliders[i];
        if (collider.fat.Contains(TightBoundsOf(stores.bodies, colliders, i))) return;
        SetFatBounds(stores.settings, stores.bodies, colliders, i);
        colliders.TreeOf(collider).Update(i, collider.fat);
        outsideFatBounds.Forget(i);
        collider.previous = {};
        colliders.Queue(i);
    });
}

}  // namespace

void FindAwakeIslands(const BodyStore& bodies, const PairStore& pairs, const ConstraintColoring& coloring,
                      std::span<uint32_t> roots) {
    UnionFind sets(roots);
    pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = pairs.pairs[index];
        if (!pair.touching || pair.fixedB) return;
        sets.Unite(bodies.cold[pair.bodyA].awakePlace, bodies.cold[pair.bodyB].awakePlace);
    });
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        for (const ConstraintColoring::Entry& entry : coloring.At(c).Of(ConstraintColoring::Kind::Joint))
            if (!entry.fixedA && !entry.fixedB)
                sets.Unite(bodies.cold[entry.bodyA].awakePlace, bodies.cold[entry.bodyB].awakePlace);
    for (uint32_t i = 0; i < roots.size(); ++i) roots[i] = sets.Find(i);
}

void PutToSleep(const SleepStores& stores, CollidersOutsideFatBounds& outsideFatBounds,
                std::span<const uint32_t> bodies) {
    const uint32_t island = stores.sleeping.Add(bodies);
    for (uint32_t body : bodies) {
        stores.bodies.cold[body].sleepingIsland = island;
        stores.bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
        stores.bodies.ForgetForces(body);
        stores.bodies.MarkAsleep(body);
        RefitFatBounds(stores, outsideFatBounds, body);
    }
    for (uint32_t body : bodies)
        stores.joints.VisitOf(body, [&](uint32_t joint) {
            if (!MovesAwake(stores.bodies, stores.joints, joint)) UncolorJoint(stores.joints, stores.coloring, joint);
        });
}

void RestPairs(const BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring) {
    const auto awake = [&](uint32_t body) { return bodies.dynamics[body].awake; };
    pairs.active.Visit([&](uint32_t index) {
        Pair& pair = pairs.pairs[index];
        if (awake(pair.bodyA) || awake(pair.bodyB)) return;
        UncolorPair(pairs, coloring, index);
        pair.touching = false;
        pairs.active.Erase(index);
    });
}

Array<uint32_t> IslandToSleep(WorldState& world, uint32_t body) {
    ReserveForChange(world);
    Array<uint32_t> roots(world.bodies.awake.size());
    FindAwakeIslands(world.bodies, world.pairs, world.coloring, roots);
    const uint32_t root = roots[world.bodies.cold[body].awakePlace];
    Array<uint32_t> members;
    for (size_t i = 0; i < roots.size(); ++i)
        if (roots[i] == root) members.push_back(world.bodies.awake[i]);
    if (world.bodies.notesSleepChanges) ReserveMore(world.bodies.sleepChanges, members.size());
    Array<uint32_t> room;
    room.reserve(members.size());
    world.sleeping.Reserve(std::move(room));
    return members;
}

void SleepAsIsland(WorldState& world, std::span<const uint32_t> bodies) {
    PutToSleep(world, world.outsideFatBounds, bodies);
    RestPairs(world.bodies, world.pairs, world.coloring);
}

}  // namespace fulcrum
