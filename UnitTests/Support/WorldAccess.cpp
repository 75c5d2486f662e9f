#include <Fulcrum/UnitTests/Support/WorldAccess.h>

namespace fulcrum::testing {

namespace {

// An explicit instantiation may name what is private.
using Member = std::unique_ptr<WorldState> PhysicsSystem::*;
Member WorldMember();
template <Member kMember>
struct Opened {
    friend Member WorldMember() { return kMember; }
};
template struct Opened<&PhysicsSystem::world_>;

}  // namespace

WorldState& WorldOf(PhysicsSystem& system) { return *(system.*WorldMember()); }

}  // namespace fulcrum::testing
