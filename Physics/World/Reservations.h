// Room for a change of the world, asked for before anything is changed: a call that runs out of memory has no effect.
// Each call of the interface that changes more than numbers reserves, then calls WorldLock::Exclusive::Begin, then
// changes the world and asks for no more memory. Lists whose length depends on the world alone are covered here, those
// of single stores by their Reserve functions. Between steps, under the world's lock; one thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// What a change adds, at most.
struct Additions {
    size_t bodies = 0, joints = 0, sensors = 0;
    bool worldBody = false;   // BodyStore::worldBody
    size_t colliders = 0;     // in the store
    size_t placed = 1;        // bodies that it places
    size_t removedPairs = 0;  // that contact events may report
    // Colliders, new in these trees.
    uint32_t inStatic = 0, inMoving = 0, inSensors = 0;
    uint32_t& InTree(bool isMoving, bool isSensor) { return isSensor ? inSensors : isMoving ? inMoving : inStatic; }
};

// Also for all bodies and joints that the change may wake, put to sleep, remove or have searched for pairs.
void ReserveForChange(WorldState& world, const Additions& more = {});
// For a change that wakes this body and what sleeps with it, and no others.
void ReserveToWake(WorldState& world, uint32_t body);
void ReserveToWake(WorldState& world, const Joint& joint);  // its bodies

// Pairs of a body, with all their manifolds.
size_t CountPairsOf(const WorldState& world, uint32_t body);

}  // namespace fulcrum
