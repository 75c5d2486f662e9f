// Random numbers, places and rotations for tests and kernels: from the engine's bits alone, so the same on every
// machine, unlike the distributions of <random>, if no call has two of them as arguments: compilers evaluate arguments
// in different orders. Draw into names or between braces. One thread.
#pragma once

#include <Fulcrum/Math/Quaternion.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace fulcrum::testing {

class RandomPoses {
public:
    explicit RandomPoses(uint32_t seed) : engine_(seed) {}
    // Uniform in [low, high).
    float Between(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
    }
    bool Chance(float probability) { return Between(0, 1) < probability; }
    uint32_t Below(uint32_t count) { return static_cast<uint32_t>(engine_() % count); }
    Vector3 InBox(float half) {
        const float x = Between(-half, half), y = Between(-half, half), z = Between(-half, half);
        return Vector3(x, y, z);
    }
    Vector3 InCube() { return InBox(1); }
    Vector3 Direction() {
        for (;;) {
            const Vector3 v = InCube();
            if (Length(v) > 0.1f && Length(v) < 1) return Normalized(v);
        }
    }
    Quaternion Rotation() {
        for (;;) {
            const Vector3 v = InCube();
            const Quaternion q{v.x(), v.y(), v.z(), Between(-1, 1)};
            if (LengthSquared(q) > 0.01f && LengthSquared(q) < 1) return Normalized(q);
        }
    }
    // One of the 24 rotations that map the axes onto each other, or none: parallel faces.
    Quaternion QuarterTurns() {
        const float h = std::sqrt(0.5f);
        const Quaternion turns[4] = {{0, 0, 0, 1}, {h, 0, 0, h}, {0, h, 0, h}, {0, 0, h, h}};
        const Quaternion first = turns[engine_() % 4], second = turns[engine_() % 4];
        return Normalized(first * second);
    }

private:
    std::mt19937 engine_;
};

}  // namespace fulcrum::testing
