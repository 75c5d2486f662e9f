#include <Fulcrum/Physics/World/Sleeping.h>

#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <vector>

namespace fulcrum {

namespace {

// What falls asleep outside its fat bounds, because it was fast or the step long, would not be found until it
// wakes.
void RefitFatBounds(WorldState& world, uint32_t body) {
    VisitColliders(world, body, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        if (collider.fat.Contains(TightBoundsOf(world, i))) return;
        SetFatBounds(world, i);
        world.colliders.TreeOf(collider).Update(i, collider.fat);
        world.outsideFatBounds.Forget(i);
        collider.previous = {};
        world.colliders.Queue(i);
    });
}

}  // namespace

void FindAwakeIslands(const WorldState& world, std::span<uint32_t> roots) {
    UnionFind sets(roots);
    world.pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = world.pairs.pairs[index];
        if (!pair.touching || pair.fixedB) return;
        sets.Unite(world.bodies.cold[pair.bodyA].awakePlace, world.bodies.cold[pair.bodyB].awakePlace);
    });
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        for (const ConstraintColoring::Entry& entry : world.coloring.At(c).Of(ConstraintColoring::Kind::Joint))
            if (!entry.stillA && !entry.stillB)
                sets.Unite(world.bodies.cold[entry.bodyA].awakePlace, world.bodies.cold[entry.bodyB].awakePlace);
    for (uint32_t i = 0; i < roots.size(); ++i) roots[i] = sets.Find(i);
}

void PutToSleep(WorldState& world, std::span<const uint32_t> bodies) {
    const uint32_t island = world.sleeping.Add(bodies);
    for (uint32_t body : bodies) {
        world.bodies.cold[body].sleepingIsland = island;
        world.bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
        world.bodies.ForgetForces(body);
        world.bodies.MarkAsleep(body);
        RefitFatBounds(world, body);
    }
    for (uint32_t body : bodies)
        world.joints.VisitOf(body, [&](uint32_t joint) {
            if (!MovesAwake(world, joint)) UncolorJoint(world, joint);
        });
}

void RestPairs(WorldState& world) {
    const auto awake = [&](uint32_t body) { return world.bodies.dynamics[body].awake; };
    world.pairs.active.Visit([&](uint32_t index) {
        Pair& pair = world.pairs.pairs[index];
        if (awake(pair.bodyA) || awake(pair.bodyB)) return;
        UncolorPair(world.pairs, world.coloring, index);
        pair.touching = false;
        world.pairs.active.Erase(index);
    });
}

void SleepIslandOf(WorldState& world, uint32_t body) {
    std::vector<uint32_t> roots(world.bodies.awake.size());
    FindAwakeIslands(world, roots);
    const uint32_t root = roots[world.bodies.cold[body].awakePlace];
    std::vector<uint32_t> members;
    for (size_t i = 0; i < roots.size(); ++i)
        if (roots[i] == root) members.push_back(world.bodies.awake[i]);
    PutToSleep(world, members);
    RestPairs(world);
}

}  // namespace fulcrum
