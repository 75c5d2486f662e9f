// Access to the internal state of a system, for tests that corrupt it on purpose.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum::testing {

WorldState& WorldOf(PhysicsSystem& system);

}  // namespace fulcrum::testing
