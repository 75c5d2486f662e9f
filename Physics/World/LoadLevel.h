// How far a contact or joint exceeds its accuracy target with the system's effort, quantized to powers of two
// (Stages/ContactLoads.h); determines its island's effort.
#pragma once

#include <cstdint>

namespace fulcrum {

inline constexpr int kMostLevel = 31;

struct LoadLevel {
    uint8_t level = 0;   // persistent level
    uint8_t recent = 0;  // level of the last step
    uint8_t steps = 0;   // number of steps for which it has exceeded `level`
    // SolverGroup::stiffness of the last step, at least 1; 0: not solved yet.
    uint8_t stiffness = 0;
};

// Whether more effort makes the error of a joint less. Joints that disagree part as far with any effort: such a one
// gets no more than it had before it asked for more, as long as its error stays about the same (Stages/ContactLoads.h).
struct EffortTrial {
    float error = 0;            // before the effort rose, of a quarter of the target; 0: no trial
    float effort = 0;           // of its island then: the substep over the system's
    float least = 0, most = 0;  // errors of the last steps
    uint8_t level = 0;          // LoadLevel::level then
    bool isInVain = false;
    uint16_t steps = 0;  // since `least` and `most` began; if in vain, for which the error has been another
};

struct GapLevel {
    LoadLevel load;
    EffortTrial trial;
};

}  // namespace fulcrum
