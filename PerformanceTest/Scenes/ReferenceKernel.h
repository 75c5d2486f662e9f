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

    // ms, wall clock, of some hundred units of work one after the other, each of a tenth of a millisecond; with several
    // threads of as many units at once.
    std::vector<double> Time(int threads) const;

private:
    float Work(uint32_t& place) const;

    std::vector<float> memory_;  // more than caches of second level hold
};

// How many units take as long as `ms`: so many in a row have that as the median of their sums, by interpolation. What
// interrupts a step of 10 ms three times and one of 0.1 ms hardly ever thus does the same to the units. `sequences`
// of units that followed each other; > 0 units.
double UnitsIn(double ms, const std::vector<std::vector<double>>& sequences);

}  // namespace fulcrum
