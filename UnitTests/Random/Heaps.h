// Random heaps: bodies of all convex shapes and of compounds, of any density, some of them jointed, that fall into a
// pit. They overlap nowhere and all joints are satisfied at the start. One thread per call.
#pragma once

#include <Fulcrum/UnitTests/Random/Mechanism.h>

namespace fulcrum::testing {

struct Heap {
    Mechanism mechanism;  // the pit, whose floor is at y = 0, is made of its static bodies
    float halfWidth = 0;  // m, of the pit along x and z
};

// Of 12 to 40 bodies.
Heap RandomHeap(uint64_t seed);

// For the trial's time, and five seconds more in which what swings and rolls is damped.
struct HeapFall {
    // m: the largest gain of energy over the least so far, by the weight of all; infinite if a number is not finite.
    double gain = 0;
    double speed = 0;  // m/s, of the fastest point of any body, at most in the last second
    int lost = 0;      // bodies below the floor or outside the pit at the end
};
HeapFall DropHeap(const Heap& heap, const Trial& trial);

}  // namespace fulcrum::testing
