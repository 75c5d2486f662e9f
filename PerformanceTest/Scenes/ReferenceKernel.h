// A fixed amount of work whose time tells how fast the machine currently is: arithmetic on data in the first-level
// cache, and reads from memory. Contains no code of the engine, and does not use its compiler flags. Called by the
// benchmark before and after each run of a scene; starts threads of its own.
#pragma once

#include <cstdint>
#include <vector>

namespace fulcrum {

// Saved runs are comparable only if this is equal: increment with each change of the kernel.
inline constexpr int kReferenceKernelVersion = 1;

class ReferenceKernel {
public:
    ReferenceKernel();

    // ms, wall clock, of some hundred units of work one after the other, each of a tenth of a millisecond; with several
    // threads of as many units at once.
    std::vector<double> Time(int threads) const;

private:
    float Work(uint32_t& place) const;

    std::vector<float> memory_;  // more than caches of second level hold
};

// The number of units that take `ms`: the number of consecutive units whose median total time is that, interpolated. So
// interruptions, which hit a step of 10 ms often and one of 0.1 ms hardly ever, affect the units alike. `sequences`
// of units that followed each other; > 0 units.
double UnitsIn(double ms, const std::vector<std::vector<double>>& sequences);

}  // namespace fulcrum
