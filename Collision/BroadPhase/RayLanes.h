// A packet of rays that lie close together, one per lane, tested against one box after another. Used by batched ray
// casts. Allocates nothing.
#pragma once

#include <Fulcrum/Math/Wide.h>

#include <cstdint>

namespace fulcrum {

struct RayLanes {
    static constexpr int kMost = 32;  // rays

    // Ray i is column i: its origin, as it meets the lower and the upper planes of boxes, and 1 / displacement.
    alignas(32) float toLower[3][kMost] = {}, toUpper[3][kMost] = {}, inverse[3][kMost] = {};
    // The largest fraction; negative: the lane is empty.
    alignas(32) float limit[kMost];
    int count = 0;  // lanes that may hold rays

    RayLanes() {
        for (float& l : limit) l = -1;
    }

    void Add(const float (&lower)[3], const float (&upper)[3], const float (&inverses)[3], float maxFraction) {
        for (int axis = 0; axis < 3; ++axis) {
            toLower[axis][count] = lower[axis];
            toUpper[axis][count] = upper[axis];
            inverse[axis][count] = inverses[axis];
        }
        limit[count++] = maxFraction;
    }

    // Boxes are enlarged by `pad` m.
    void Widen(float pad) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < kMost; i += 8) {
                (Wide<8>::Load(toLower[axis] + i) + Wide<8>(pad)).Store(toLower[axis] + i);
                (Wide<8>::Load(toUpper[axis] + i) - Wide<8>(pad)).Store(toUpper[axis] + i);
            }
        }
    }

    float LargestLimit() const {
        Wide<8> largest = Wide<8>::Load(limit);
        for (int i = 8; i < kMost; i += 8) largest = Max(largest, Wide<8>::Load(limit + i));
        return HorizontalMax(largest);
    }

    // The rays that hit the box. `slack`: a factor of the fraction at which they leave it, which covers rounding.
    uint32_t Intersecting(const float (&low)[3], const float (&high)[3], float slack) const {
        constexpr int kStep = kLanes >= 8 ? 8 : 4;
        using Lanes = Wide<kStep>;
        uint32_t bits = 0;
        for (int i = 0; i < count; i += kStep) {
            Lanes enter(0.0f), leave = Lanes::Load(limit + i);
            for (int axis = 0; axis < 3; ++axis) {
                const Lanes slope = Lanes::Load(inverse[axis] + i);
                const Lanes lower = (Lanes(low[axis]) - Lanes::Load(toLower[axis] + i)) * slope;
                const Lanes upper = (Lanes(high[axis]) - Lanes::Load(toUpper[axis] + i)) * slope;
                enter = Max(enter, Min(lower, upper));
                leave = Min(leave, Max(lower, upper));
            }
            bits |= (enter <= leave * Lanes(slack)).ToBits() << i;
        }
        return bits;
    }
};

}  // namespace fulcrum
