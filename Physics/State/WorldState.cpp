#include <Fulcrum/Physics/State/WorldState.h>

#include <algorithm>

namespace fulcrum {

namespace {

void WakeOne(WorldState& world, uint32_t body) {
    BodyStore& bodies = world.bodies;
    bodies.MarkAwake(body);
    bodies.cold[body].sleepingIsland = SleepingIslands::kNone;
    bodies.UpdateInertia(body);
    const Vector3 acceleration = world.settings.gravity * bodies.dynamics[body].gravityFactor;
    for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] = acceleration[k];
    const BodyCold& cold = bodies.cold[body];
    for (uint32_t i = cold.firstCollider; i < cold.firstCollider + cold.colliderCount; ++i) {
        world.colliders.colliders[i].previous = {};
        world.colliders.Queue(i);
    }
}

}  // namespace

void WakeBody(WorldState& world, uint32_t body) {
    const BodyDynamics& d = world.bodies.dynamics[body];
    if (d.motion != MotionType::Dynamic || d.frozen) return;
    if (d.awake) {
        world.bodies.dynamics[body].slowSeconds = 0;
        return;
    }
    const uint32_t island = world.bodies.cold[body].sleepingIsland;
    if (island == SleepingIslands::kNone) {
        WakeOne(world, body);
        return;
    }
    for (uint32_t member : world.sleeping.Bodies(island)) WakeOne(world, member);
    world.sleeping.Remove(island);
}

void WakeInside(WorldState& world, const Bounds& bounds) {
    // Waking changes no tree, but collect first: a query must not see the world change under it.
    std::vector<uint32_t> found;
    world.colliders.movingTree.Query(bounds, [&](uint32_t collider) { found.push_back(world.colliders.colliders[collider].body); });
    std::sort(found.begin(), found.end());
    for (uint32_t body : found) WakeBody(world, body);
}

size_t WorldState::MemoryUsed() const {
    size_t bytes = sizeof(*this) + bodies.MemoryUsed() + colliders.MemoryUsed() + pairs.MemoryUsed() +
                   colouring.MemoryUsed() + sleeping.MemoryUsed() + solver.MemoryUsed() + scratch.CapacityInBytes() +
                   changes.capacity() + activated.capacity() * sizeof(uint32_t) + newPairs.capacity() * sizeof(uint64_t);
    for (const WorkerFindings& f : findings)
        bytes += sizeof(f) + f.colliders.capacity() * sizeof(uint32_t) + f.pairs.capacity() * sizeof(uint64_t);
    return bytes;
}

}  // namespace fulcrum
