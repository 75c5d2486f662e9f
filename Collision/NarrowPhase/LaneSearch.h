// Largest and smallest of many floats and their places, eight at a time. Used by the narrow phase.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// By halves: three comparisons deep. The result does not depend on the order; no lane is NaN.
inline float Largest(Wide<8> a) {
    float lanes[8];
    a.Store(lanes);
    const Wide<4> m = Max(Wide<4>::Load(lanes), Wide<4>::Load(lanes + 4));
    return Max(Max(m[0], m[2]), Max(m[1], m[3]));
}
inline float Smallest(Wide<8> a) { return -Largest(-a); }

// The first of `blocks` times eight values for which the mask that `test` makes of them is true; 0 if there is none.
template <class Test>
inline int FirstWhere(const Wide<8>* values, int blocks, const Test& test) {
    for (int k = 0; k < blocks; ++k) {
        const uint32_t hits = test(values[k]).ToBits();
        if (hits != 0) return 8 * k + __builtin_ctz(hits);
    }
    return 0;
}

}  // namespace fulcrum
