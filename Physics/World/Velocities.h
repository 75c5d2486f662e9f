// Velocities that the user sets. Called between steps, under the world's lock.
#pragma once

#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// Any finite velocity, clamped to what bodies support.
void SetVelocityOf(WorldState& world, uint32_t body, Vector3 linear, Vector3 angular);

// The same for a body that is not static; wakes it, and what is joined to a kinematic one.
void GiveVelocity(WorldState& world, uint32_t body, const Vector3& linear, const Vector3& angular);

// Checks what BodyInterface::SetVelocity was given and does it: wakes the body, and what is joined to a kinematic one.
MaybeError ChangeVelocity(WorldState& world, const WorldLock::Exclusive& alone, BodyId id, const Vector3& linear,
                          const Vector3& angular);

}  // namespace fulcrum
