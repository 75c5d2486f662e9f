// SplitMix64, the random numbers of all scenes: the same on every machine. Source: Steele, Lea and Flood, "Fast
// Splittable Pseudorandom Number Generators", 2014.
#pragma once

#include <cstdint>

namespace fulcrum {

class Random {
public:
    explicit Random(uint64_t seed) : state_(seed) {}

    uint64_t Next() {
        uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
        return z ^ (z >> 31);
    }
    // 0 <= x < 1 in steps of 2^-24: exact in float too.
    double Unit() { return static_cast<double>(Next() >> 40) * 0x1p-24; }
    double Between(double low, double high) { return low + (high - low) * Unit(); }

private:
    uint64_t state_;
};

}  // namespace fulcrum
