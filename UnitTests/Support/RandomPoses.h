// Random places and rotations for tests and kernels: from the engine's bits alone, so the same on every machine. One thread.
#pragma once

#include <Fulcrum/Math/Quaternion.h>

#include <cmath>
#include <random>

namespace fulcrum::testing {

class RandomPoses {
public:
    explicit RandomPoses(uint32_t seed) : engine_(seed) {}
    float Between(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
    }
    Vector3 InCube() {
        const float x = Between(-1, 1), y = Between(-1, 1), z = Between(-1, 1);
        return Vector3(x, y, z);
    }
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
