// Bodies whose pose the user sets, and what follows for joints, bounds and contacts. Called between steps, under the
// world's lock.
#pragma once

#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <span>

namespace fulcrum {

// A body, and where its own frame is to be.
struct BodyPlace {
    uint32_t body = 0;
    Pose pose{};  // the rotation is a unit quaternion
};

// Puts bodies, each named once, there at once; they wake, with what rested on them and what they now touch. A frozen
// body is free again.
void Teleport(WorldState& world, std::span<const BodyPlace> places);
// The same, by a displacement of each body, in ascending order, m. Asks for no memory; nothing follows.
void Teleport(WorldState& world, std::span<const uint32_t> bodies, FunctionRef<Vector3(uint32_t)> displacementOf);

// Before a step: what joints hold to a body that the user has moved since the last one, and to nothing else, keeps its
// place relative to it, where a joint between them is now far apart. So a car is moved by its chassis, and a ragdoll by
// all its bodies, one by one.
void FollowMovedBodies(WorldState& world);

}  // namespace fulcrum
