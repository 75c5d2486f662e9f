// What sleeps is woken: by a contact, a joint, a call of the interface. Bodies that fell asleep together wake together.
// One thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// What changes where bodies wake or fall asleep: they and their islands, the colliders whose pairs are to be searched,
// the joints that act, or act no more. The settings are read.
struct SleepStores {
    // Not explicit: what changes the world between steps hands over all of it.
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

// Wakes a body, the island it sleeps in and what is joined to them; their colliders are queued for the search of pairs.
void WakeBody(const SleepStores& stores, uint32_t body);
// Wakes what enabled joints hold to the body, which itself may be one that does not sleep.
void WakeJoined(const SleepStores& stores, uint32_t body);
// Wakes what overlaps the bounds.
void WakeInside(const SleepStores& stores, const Bounds& bounds);
// Has the body's pairs searched anew.
void RequeueColliders(const BodyStore& bodies, ColliderStore& colliders, uint32_t body);

}  // namespace fulcrum
