// Finds efforts that oscillate: those of an island that rise again after they have fallen, though nothing has landed,
// left, been joined or parted in between. Used by LabWorld; one thread.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace fulcrum::accuracy {

class EffortReturns {
public:
    // After each step. Returns how many islands now have more substeps than in the step before, had fewer in that than
    // some steps earlier, and have had the same contacts and joints since then.
    uint32_t Sample(const PhysicsSystem& system);

private:
    struct Island {
        int substeps = 0;
        bool hasFallen = false;
    };
    std::unordered_map<uint64_t, Island> before_, now_;  // by a hash of their contacts and joints
    std::vector<uint32_t> islandOf_;                     // by BodyId::index
    std::vector<uint64_t> keys_;                         // by island
    std::vector<int> substeps_;                          // by island
};

}  // namespace fulcrum::accuracy
