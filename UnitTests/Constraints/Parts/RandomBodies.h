// Random bodies and rows for the tests of the constraint parts, and the same things spread over lanes.
#pragma once

#include <Fulcrum/Constraints/Parts/AxisPart.h>

#include <cstdint>
#include <cstring>
#include <random>

namespace fulcrum::testing {

class Random {
public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    // Uniform in [low, high), from the engine's bits alone: the same on every standard library.
    float Number(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
    }
    bool Chance(float probability) { return Number(0.0f, 1.0f) < probability; }
    Vector3 Vector(float size) {
        const float x = Number(-size, size), y = Number(-size, size), z = Number(-size, size);
        return Vector3(x, y, z);
    }
    Vector3 Direction() { return Normalized(Vector3(Vector(1.0f) + Vector3(0.01f, 0.02f, 0.03f))); }

private:
    std::mt19937 engine_;
};

struct RandomBody {
    Vector3 position;
    Twist<float> velocity;
    InverseMass<float> mass;
};

inline RandomBody MakeBody(Random& random) {
    RandomBody body;
    body.position = random.Vector(2.0f);
    body.velocity = {random.Vector(3.0f), random.Vector(3.0f)};
    body.mass.mass = random.Number(0.1f, 2.0f);
    const Vector3 axis = random.Direction();
    const float w = random.Number(-1.0f, 1.0f);
    const Matrix3 rotation = ToMatrix(Normalized(Quaternion{axis.x(), axis.y(), axis.z(), w}));
    const float a = random.Number(0.2f, 5.0f), b = random.Number(0.2f, 5.0f), c = random.Number(0.2f, 5.0f);
    body.mass.inertia = RotatedDiagonal(rotation, Vector3(a, b, c));
    return body;
}

inline AxisFrame<float> MakeFrame(Random& random) {
    const Vector3 r1 = random.Vector(1.0f), r2 = random.Vector(1.0f), axis = random.Direction();
    return {r1, r2, axis};
}

inline uint32_t Bits(float x) {
    uint32_t bits;
    std::memcpy(&bits, &x, sizeof(bits));
    return bits;
}
inline bool SameBits(const Vector3& a, const Vector3& b) {
    return Bits(a.x()) == Bits(b.x()) && Bits(a.y()) == Bits(b.y()) && Bits(a.z()) == Bits(b.z());
}
inline bool SameBits(const Twist<float>& a, const Twist<float>& b) {
    return SameBits(a.linear, b.linear) && SameBits(a.angular, b.angular);
}

template <int N>
Vector3 Lane(const Vec3<Wide<N>>& v, int lane) {
    return Vector3(v.x()[lane], v.y()[lane], v.z()[lane]);
}
template <int N>
Twist<float> Lane(const Twist<Wide<N>>& twist, int lane) {
    return {Lane(twist.linear, lane), Lane(twist.angular, lane)};
}
template <int N>
void PutLane(Vec3<Wide<N>>& v, int lane, const Vector3& from) {
    for (int k = 0; k < 3; ++k) v[k].Set(lane, from[k]);
}
template <int N>
void PutLane(Twist<Wide<N>>& twist, int lane, const Twist<float>& from) {
    PutLane(twist.linear, lane, from.linear);
    PutLane(twist.angular, lane, from.angular);
}
template <int N>
void PutLane(InverseMass<Wide<N>>& mass, int lane, const InverseMass<float>& from) {
    mass.mass.Set(lane, from.mass);
    mass.inertia.xx.Set(lane, from.inertia.xx);
    mass.inertia.yy.Set(lane, from.inertia.yy);
    mass.inertia.zz.Set(lane, from.inertia.zz);
    mass.inertia.xy.Set(lane, from.inertia.xy);
    mass.inertia.xz.Set(lane, from.inertia.xz);
    mass.inertia.yz.Set(lane, from.inertia.yz);
}

}  // namespace fulcrum::testing
