// By how much a contact or a joint is off at the system's effort, as a level in powers of two
// (Stages/ContactLoads.h): what its island's effort follows.
#pragma once

#include <cstdint>

namespace fulcrum {

struct LoadLevel {
    uint8_t level = 0;   // that lasts
    uint8_t recent = 0;  // of the last step
    uint8_t steps = 0;   // for how many it has been more than `level`
    // SolverGroup::stiffness of the last step, at least 1; 0: it has not been solved yet.
    uint8_t stiffness = 0;
};

}  // namespace fulcrum
