#include <Fulcrum/Physics/World/Filters.h>

#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/Materials.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>

namespace fulcrum {

namespace {

bool LayersAllow(const WorldState& world, const Pair& pair) {
    return world.settings.layerCollides[world.bodies.dynamics[pair.bodyA].layer] >>
               world.bodies.dynamics[pair.bodyB].layer &
           1u;
}

bool IsForbidden(const WorldState& world, const Pair& pair) {
    return !LayersAllow(world, pair) || !FiltersAllow(world.bodies, pair.bodyA, pair.bodyB) ||
           !ListenerAllows(world.listener, world.bodies, pair.bodyA, pair.bodyB);
}

void RemoveIfForbidden(WorldState& world, uint32_t index) {
    const Pair& pair = world.pairs.pairs[index];
    if (!IsForbidden(world, pair)) return;
    WakeBody(world, pair.bodyA);
    WakeBody(world, pair.bodyB);
    RemovePair(world.pairs, world.coloring, index);
}

void RemoveAllForbiddenPairs(WorldState& world) {
    for (uint32_t i = 0; i < world.pairs.pairs.size(); ++i)
        if (world.pairs.pairs[i].exists && !world.pairs.pairs[i].isMore) RemoveIfForbidden(world, i);
}

}  // namespace

bool FiltersAllow(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB) {
    const BodyFilter& a = bodies.FilterOf(std::min(bodyA, bodyB));
    const BodyFilter& b = bodies.FilterOf(std::max(bodyA, bodyB));
    if ((a.category & b.mask) == 0 || (b.category & a.mask) == 0) return false;
    const GroupFilter* filter = a.group.filter.get();
    return !filter || filter != b.group.filter.get() ||
           filter->Collides({a.group.group, a.group.subGroup}, {b.group.group, b.group.subGroup});
}

bool ListenerAllows(const ContactListener* listener, const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB) {
    if (!listener) return true;
    const auto [low, high] = std::minmax(bodyA, bodyB);
    return listener->ShouldCollide(bodies.IdOf(low), bodies.IdOf(high));
}

void RemoveForbiddenPairs(WorldState& world, std::span<const uint32_t> pairs) {
    for (const uint32_t pair : pairs) RemoveIfForbidden(world, pair);
}

void RefilterLayers(WorldState& world, const std::array<uint32_t, 32>& before) {
    RemoveAllForbiddenPairs(world);
    for (uint32_t body = 0; body < world.bodies.Size(); ++body) {
        const BodyDynamics& d = world.bodies.dynamics[body];
        if (!world.bodies.cold[body].exists || world.settings.layerCollides[d.layer] == before[d.layer]) continue;
        WakeBody(world, body);
        if (d.awake) RequeueColliders(world.bodies, world.colliders, body);
    }
}

void ChangeListener(WorldState& world, const ContactListener* listener) {
    world.listener = listener;
    RemoveAllForbiddenPairs(world);
    world.pairs.KeepListenersData(listener != nullptr);  // without surface velocities
    // Resets the previous listener's changes of contacts, which may have held what sleeps, and searches for pairs that
    // it had forbidden.
    for (uint32_t i = 0; i < world.pairs.contacts.size(); ++i) {
        const uint32_t pair = world.pairs.contacts[i].pair;
        if (pair == PairStore::kNone) continue;
        ContactRecord& record = world.pairs.records[i];
        const float friction = record.friction, restitution = record.restitution;
        CombineMaterials(world.bodies, world.colliders, world.pairs, pair);
        bool wasChanged = record.friction != friction || record.restitution != restitution;
        for (const auto mark :
             {ContactRecord::kSurfaceVelocity, ContactRecord::kMassOverride, ContactRecord::kSensed}) {
            wasChanged |= record.Has(mark);
            record.Set(mark, false);
        }
        if (!wasChanged) continue;
        for (const uint32_t body : {world.pairs.pairs[pair].bodyA, world.pairs.pairs[pair].bodyB})
            WakeBody(world, body);
    }
    for (uint32_t body : world.bodies.awake) RequeueColliders(world.bodies, world.colliders, body);
}

}  // namespace fulcrum
