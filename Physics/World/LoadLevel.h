// How far a contact or joint exceeds its accuracy target with the system's effort, quantized to powers of two
// (Stages/ContactLoads.h); determines its island's effort.
#pragma once

#include <cstdint>

namespace fulcrum {

struct LoadLevel {
    uint8_t level = 0;   // persistent level
    uint8_t recent = 0;  // level of the last step
    uint8_t steps = 0;   // number of steps for which it has exceeded `level`
    // SolverGroup::stiffness of the last step, at least 1; 0: not solved yet.
    uint8_t stiffness = 0;
};

}  // namespace fulcrum
