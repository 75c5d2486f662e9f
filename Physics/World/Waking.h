// What sleeps is woken: by a contact, a joint, a call of the interface. Bodies that fell asleep together wake together.
// One thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// Wakes a body, the island it sleeps in and what is joined to them; their colliders are queued for the search of pairs.
void WakeBody(WorldState& world, uint32_t body);
// Wakes what enabled joints hold to the body, which itself may be one that does not sleep.
void WakeJoined(WorldState& world, uint32_t body);
// Wakes what overlaps the bounds.
void WakeInside(WorldState& world, const Bounds& bounds);
// Has the body's pairs searched anew.
void RequeueColliders(WorldState& world, uint32_t body);

}  // namespace fulcrum
