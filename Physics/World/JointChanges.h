// Joints that are enabled, disabled or removed, and what follows for bodies, pairs and colors. One thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

void WakeBodiesOf(WorldState& world, const Joint& joint);
// Brings everything in line with `enabled`. The bodies wake.
void EnableJoint(WorldState& world, uint32_t joint, bool enabled);
// Removes a joint; its bodies wake.
void RemoveJoint(WorldState& world, uint32_t joint);

}  // namespace fulcrum
