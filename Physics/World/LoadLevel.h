// How far a contact would exceed its accuracy target with the settings' effort, quantized to powers of two
// (Stages/ContactLoads.h); determines whether its island is solved directly.
#pragma once

#include <cstdint>

namespace fulcrum {

inline constexpr int kMostLevel = 31;

struct LoadLevel {
    uint8_t level = 0;   // persistent level
    uint8_t recent = 0;  // level of the last step
    uint8_t steps = 0;   // number of steps for which it has exceeded `level`
};

}  // namespace fulcrum
