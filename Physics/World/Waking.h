// Wakes sleeping bodies: by contacts, joints and calls of the interface. Bodies that fell asleep together wake
// together. One thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// The stores that change when bodies wake or fall asleep: bodies and islands, colliders whose pairs must be searched,
// colors of joints. The settings are read.
struct SleepStores {
    // Implicit, for callers that have the whole world.
    SleepStores(WorldState& world)
        : settings(world.settings),
          bodies(world.bodies),
          colliders(world.colliders),
          joints(world.joints),
          coloring(world.coloring),
          sleeping(world.sleeping) {}

    const SystemSettings& settings;
    BodyStore& bodies;
    ColliderStore& colliders;
    JointStore& joints;
    ConstraintColoring& coloring;
    SleepingIslands& sleeping;
};

// Wakes a body, the island it sleeps in and bodies jointed to them; their colliders are queued for the search of pairs.
void WakeBody(const SleepStores& stores, uint32_t body);
// Wakes those dynamic bodies that sleep and for which wakes(body) is true, with their islands.
template <class Wakes>
void WakeIf(const SleepStores& stores, const Wakes& wakes) {
    for (uint32_t body = 0; body < stores.bodies.Size(); ++body) {
        const BodyDynamics& d = stores.bodies.dynamics[body];
        if (d.motion == MotionType::Dynamic && !d.awake && stores.bodies.cold[body].exists && wakes(body))
            WakeBody(stores, body);
    }
}
// Wakes bodies connected to the body by enabled joints; the body itself may be awake or static.
void WakeJoined(const SleepStores& stores, uint32_t body);
// Wakes bodies that overlap the bounds.
void WakeInside(const SleepStores& stores, const Bounds& bounds);
// Queues the body's colliders for the search of pairs.
void RequeueColliders(const BodyStore& bodies, ColliderStore& colliders, uint32_t body);

}  // namespace fulcrum
