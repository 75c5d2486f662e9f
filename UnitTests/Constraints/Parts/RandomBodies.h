// Random bodies and rows for the tests of the constraint parts, and the same things spread over lanes.
#pragma once

#include <Fulcrum/Constraints/Parts/AxisPart.h>
#include <Fulcrum/Constraints/Parts/RowPart.h>
#include <Fulcrum/Constraints/Parts/SpringSoftness.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <cstdint>
#include <cstring>

namespace fulcrum::testing {

// In three draws, whatever they are.
inline Vector3 AnyDirection(RandomPoses& random) {
    return Normalized(Vector3(random.InBox(1) + Vector3(0.01f, 0.02f, 0.03f)));
}
// About any direction by any angle.
inline Quaternion AnyRotation(RandomPoses& random) {
    constexpr float kPi = 3.14159265f;
    const Vector3 axis = AnyDirection(random);
    return RotationFromVector(Vector3(axis * random.Between(-kPi, kPi)));
}

struct RandomBody {
    Vector3 position;
    Twist<float> velocity;
    InverseMass<float> mass;
};

inline RandomBody MakeBody(RandomPoses& random) {
    RandomBody body;
    body.position = random.InBox(2.0f);
    body.velocity = {random.InBox(3.0f), random.InBox(3.0f)};
    body.mass.mass = Vector3::Constant(random.Between(0.1f, 2.0f));
    const Vector3 axis = AnyDirection(random);
    const float w = random.Between(-1.0f, 1.0f);
    const Matrix3 rotation = ToMatrix(Normalized(Quaternion{axis.x(), axis.y(), axis.z(), w}));
    const float a = random.Between(0.2f, 5.0f), b = random.Between(0.2f, 5.0f), c = random.Between(0.2f, 5.0f);
    body.mass.inertia = RotatedDiagonal(rotation, Vector3(a, b, c));
    return body;
}

// Another inverse mass, and the inverse inertia scaled: parts act on whatever masses they are given.
inline InverseMass<float> OverrideMass(const InverseMass<float>& mass, float inverseMass, float inverseInertiaScale) {
    InverseMass<float> result = mass;
    result.mass = Vector3::Constant(inverseMass);
    for (float* x : {&result.inertia.xx, &result.inertia.yy, &result.inertia.zz, &result.inertia.xy, &result.inertia.xz,
                     &result.inertia.yz})
        *x *= inverseInertiaScale;
    return result;
}

inline AxisFrame<float> MakeFrame(RandomPoses& random) {
    const Vector3 r1 = random.InBox(1.0f), r2 = random.InBox(1.0f), axis = AnyDirection(random);
    return {r1, r2, axis};
}

// Makes a spring of a row that is set up; a hard row where the constants are zero.
template <class Real>
void SetSpring(RowPart<Real>& part, Real dt, Real bias, Real error, const SpringConstants<Real>& constants) {
    const auto active = part.IsActive();
    const Real k = Select(active, Real(1.0f) / Select(active, part.GetEffectiveMass(), Real(1.0f)), Real(0.0f));
    const SpringSoftness<Real> spring = SpringSoftnessOf(dt, k, constants);
    part.SetBias(spring.softness.massScale * bias + spring.errorRate * error, spring.softness);
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
    for (int k = 0; k < 3; ++k) mass.mass[k].Set(lane, from.mass[k]);
    mass.inertia.xx.Set(lane, from.inertia.xx);
    mass.inertia.yy.Set(lane, from.inertia.yy);
    mass.inertia.zz.Set(lane, from.inertia.zz);
    mass.inertia.xy.Set(lane, from.inertia.xy);
    mass.inertia.xz.Set(lane, from.inertia.xz);
    mass.inertia.yz.Set(lane, from.inertia.yz);
}

}  // namespace fulcrum::testing
