// For tests that spoil what no call of the interface reaches: the world behind a system.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum::testing {

WorldState& WorldOf(PhysicsSystem& system);

}  // namespace fulcrum::testing
