// Enables, disables and removes joints, and updates bodies, pairs and colors. One thread.
#pragma once

#include <Fulcrum/Physics/World/Reservations.h>

#include <optional>

namespace fulcrum {

// Of a body that a joint may have, which the world is, too; none: no body has the id.
std::optional<MotionType> MotionOf(const WorldState& world, BodyId id);
void WakeBodiesOf(WorldState& world, const Joint& joint);
// What a new joint adds, with its bodies among those of the world.
void IncludeJoint(const WorldState& world, const JointSettings& settings, Additions& more);
// Pairs that end where it is enabled.
size_t PairsEndedBy(const WorldState& world, const Joint& joint);
// Sets `enabled` and updates everything that depends on it. The bodies wake.
void EnableJoint(WorldState& world, uint32_t joint, bool enabled);
// Removes a joint; its bodies wake.
void RemoveJoint(WorldState& world, uint32_t joint);

}  // namespace fulcrum
