// Largest and smallest of many floats and their indices, eight at a time. Used by the narrow phase.
#pragma once

#include <Fulcrum/Math/Wide.h>

#include <bit>

namespace fulcrum {

// By halving: three levels of comparisons. The result does not depend on the order; no lane is NaN.
inline float Largest(Wide<8> a) {
    float lanes[8];
    a.Store(lanes);
    const Wide<4> m = Max(Wide<4>::Load(lanes), Wide<4>::Load(lanes + 4));
    return Max(Max(m[0], m[2]), Max(m[1], m[3]));
}
inline float Smallest(Wide<8> a) { return -Largest(-a); }

// The first of `blocks` times eight values for which the mask that `test` makes of them is true; 0 if there is none. No
// branch depends on its index, within each 64 values.
template <class Test>
inline int FirstWhere(const Wide<8>* values, int blocks, const Test& test) {
    for (int from = 0; from < blocks; from += 8) {
        const int end = blocks < from + 8 ? blocks : from + 8;
        uint64_t hits = 0;
        for (int k = from; k < end; ++k) hits |= uint64_t{test(values[k]).ToBits()} << (8 * (k - from));
        if (hits != 0) return 8 * from + std::countr_zero(hits);
    }
    return 0;
}

struct Extreme {
    int index;
    float value;
};

// The vector that lies farthest along `direction`; of several, the first. The coordinates are given by lanes, `count`
// of them, a multiple of 8 and at most 256.
inline Extreme Farthest(const float* x, const float* y, const float* z, int count, const Vector3& direction) {
    const Wide<8> dx(direction.x()), dy(direction.y()), dz(direction.z());
    const auto value = [&](int i) {
        return dx * Wide<8>::Load(x + i) + dy * Wide<8>::Load(y + i) + dz * Wide<8>::Load(z + i);
    };
    Wide<8> values[256 / 8];
    Wide<8> largest = values[0] = value(0);
    const int blocks = count / 8;
    for (int k = 1; k < blocks; ++k) {
        values[k] = value(8 * k);
        largest = Max(largest, values[k]);
    }
    const float most = Largest(largest);
    const Wide<8> wanted(most);
    return {FirstWhere(values, blocks, [&](Wide<8> v) { return v == wanted; }), most};
}

}  // namespace fulcrum
