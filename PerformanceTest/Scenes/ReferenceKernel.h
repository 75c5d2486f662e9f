// Work that is the same in every build, whose time says how fast the machine is at the moment: arithmetic on what is in
// the first-level cache, and reads from memory. It has no code of the engine and none of its compiler flags. Called by
// the benchmark before and after each run of a scene; starts threads of its own.
#pragma once

#include <cstdint>
#include <vector>

namespace fulcrum {

// Saved runs are comparable only where this is the same: one more with each change of the kernel.
inline constexpr int kReferenceKernelVersion = 1;

class ReferenceKernel {
public:
    ReferenceKernel();

    // ms, wall clock: the median of some repetitions, in each of which that many threads do the whole work at once.
    double Time(int threads) const;

private:
    float Work(uint32_t seed) const;

    std::vector<float> memory_;  // more than caches of second level hold
};

}  // namespace fulcrum
