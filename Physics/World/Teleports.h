// Bodies whose pose the user sets, and what follows for joints, bounds and contacts. Called between steps, under the
// world's lock.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <span>

namespace fulcrum {

// A body, and where its own frame is to be.
struct BodyPlace {
    uint32_t body = 0;
    Pose pose{};  // the rotation is a unit quaternion
};

// Puts bodies, each named once, there at once; they wake, with what rested on them and what they now touch. Mechanisms
// whose joints are no farther apart than before do not notice. A frozen body is free again.
void Teleport(WorldState& world, std::span<const BodyPlace> places);

}  // namespace fulcrum
