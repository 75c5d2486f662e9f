// When joints count as far apart, how fast they are pulled together, and which pushes are rotated before they are
// relaxed (Docs/Joints.md). Shared by the kernels of joints and of ball joints. Free functions over lanes, no state.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

#include <cmath>

namespace fulcrum::joints {

// A joint is far apart if its gap asks for more than this fraction of the largest push speed, or for 5 cm in a substep.
// It stays so until its gap and angles are reduced to a fiftieth of that: correcting the last decimeter by velocities
// would leave energy. Joints connected to joints that are far apart are far apart from a fifth of it on.
inline float FarPush(const JointSolveSettings& settings) {
    constexpr float kFarFraction = 0.5f, kFarDistance = 0.05f;  // m
    return std::fmin(kFarFraction, kFarDistance * settings.inverseDt / settings.maxPushSpeed);
}
inline constexpr float kNearFraction = 0.02f, kFollowFraction = 0.2f;

// JointRecord::wasPulled. Joints that are far apart add the seconds for which they have not been distant.
inline constexpr float kWasFar = 1.0f, kFollowed = 0.5f;

// JointRecord::secondsOfTeleport after this step.
template <class Real>
FULCRUM_FORCE_INLINE Real SecondsLeft(const Real& before, const JointSolveSettings& settings) {
    return Max(before - Real(settings.dt), Real(0.0f));
}

// For how many seconds a joint that is far apart has not been distant. The pull ends after the time that it takes to
// move by 40 m or rotate by 40 rad: a joint that is still apart then is held apart, by a pile on it, say, and would
// jitter.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE Real SecondsNear(const Real& wasPulled, const Mask& isDistant,
                                      const JointSolveSettings& settings) {
    return Select(isDistant, Real(0.0f), Max(wasPulled - Real(kWasFar), Real(0.0f)) + Real(settings.dt));
}
inline float LongestNear(const JointSolveSettings& settings) { return 40.0f / settings.maxPushSpeed; }

// Thresholds by lane, as fractions of the largest push speed.
template <class Real>
FULCRUM_FORCE_INLINE Real FarPush(const Real& wasPulled, const JointSolveSettings& settings) {
    const float far = FarPush(settings);
    const Real following = Select(wasPulled >= Real(kFollowed), Real(kFollowFraction * far), Real(far));
    return Select(wasPulled >= Real(kWasFar), Real(kNearFraction * far), following);
}

// Whether a joint with a gap in m and these lever arms may be pulled. Some time after a teleport only if the gap is
// long for them: what a load keeps apart, in a mechanism at its limits, say, a pull would throw about.
template <class Real>
FULCRUM_FORCE_INLINE auto MayPull(const Real& gap, const Vec3<Real>& armA, const Vec3<Real>& armB,
                                  const Real& wasPulled, const Real& secondsOfTeleport) {
    constexpr float kLeastOfArms = 0.3f;
    return (secondsOfTeleport > Real(0.0f)) | (wasPulled >= Real(kFollowed)) |
           (gap * gap > (Dot<Real>(armA, armA) + Dot<Real>(armB, armB)) * Real(kLeastOfArms * kLeastOfArms));
}

// Marks lanes whose bodies have significant pseudo-velocities.
template <class Real>
FULCRUM_FORCE_INLINE Real Follows(const Real& before, const Twist<Real>& a, const Twist<Real>& b,
                                  const JointSolveSettings& settings) {
    const Real fast(kNearFraction * settings.maxPushSpeed);
    const auto isPulled = [&](const Twist<Real>& v) {
        return Dot<Real>(v.linear, v.linear) + Dot<Real>(v.angular, v.angular) > fast * fast;
    };
    return Select(isPulled(a) | isPulled(b), Real(kFollowed), before);
}

// Pull speed of joints that are far apart, proportional to the error and limited: the limit grows with the error, so
// that any gap closes within some seconds. Adds no energy, since pseudo-velocities are not part of the velocities.
template <class Real>
FULCRUM_FORCE_INLINE Real PullSpeed(const Real& error, const JointSolveSettings& settings) {
    constexpr float kMost = 3.0f, kPerSecond = 0.75f;
    const Real most =
        Clamp(Abs(error) * Real(kPerSecond), Real(settings.maxPushSpeed), Real(kMost * settings.maxPushSpeed));
    return Clamp(Real(error * Real(settings.pushRate)), -most, most);
}

// Marks what is connected to something that does not move, directly or by other joints, as near to it: what the pull
// holds up there loses the velocity that gravity gives it (BodyState::nearFixed). guided: mask of the lanes in which a
// body has locked translations, which count as such.
template <class Batch>
inline void MarkNearFixed(const Batch& batch, BodyState* pseudo, uint32_t guided = 0) {
    const uint32_t still = (batch.fixedA & ~batch.kinematicA) | (batch.fixedB & ~batch.kinematicB) | guided;
    for (int lane = 0; lane < batch.count; ++lane) {
        const bool fixedA = batch.fixedA >> lane & 1u, fixedB = batch.fixedB >> lane & 1u;
        BodyState &a = pseudo[batch.bodyA[lane]], &b = pseudo[batch.bodyB[lane]];
        const bool isNear = (still >> lane & 1u) || (!fixedA && a.nearFixed > 0) || (!fixedB && b.nearFixed > 0);
        if (!isNear) continue;
        if (!fixedA) a.nearFixed = 1;
        if (!fixedB) b.nearFixed = 1;
    }
}

// m/s, rad/s. Faster pushes have their impulses rotated with the joint before they are relaxed. Without that, a
// velocity that was pushed along one direction and relaxed along another, rotated one keeps the difference: a slider
// whose bodies were 2 rad apart gained 2 kJ. Applied only in the seconds after a teleport: in joints under load in a
// pile the other joints would not see the change of velocity.
inline constexpr float kFastPush = 1.0f;

// Whether lanes, whose fastest push in the last velocity iterations is given (m/s or rad/s), are pushed fast.
template <class Batch, class Real>
FULCRUM_FORCE_INLINE auto IsPushedFast(const Batch& batch, const Real& fastest) {
    return (fastest > Real(kFastPush)) & (batch.secondsOfTeleport > Real(0.0f));
}

// Whether a joint with these errors, m and rad, is pushed fast, and by more than what a load stretches.
template <class Real>
FULCRUM_FORCE_INLINE auto IsPushedFar(const Real& gap, const Real& angle, const Vec3<Real>& armA,
                                      const Vec3<Real>& armB, const JointSolveSettings& settings) {
    constexpr float kLeast = 0.003f;  // rad, and of the lever arms
    const Real rate(settings.pushRate), fast(kFastPush);
    const auto isLong = gap * gap > (Dot<Real>(armA, armA) + Dot<Real>(armB, armB)) * Real(kLeast * kLeast);
    return ((gap * rate > fast) & isLong) | ((angle * rate > fast) & (angle > Real(kLeast)));
}

// For these lanes, adds the change of velocity due to the rotation of a substep at once instead of in the next substep.
template <int N>
inline void AddAtOnce(const WideMask<N>& lanes, Vec3<Wide<N>>& turned, Vec3<Wide<N>>& velocity) {
    using Real = Wide<N>;
    velocity += ZeroUnless<Real>(lanes, turned);
    for (int k = 0; k < 3; ++k) turned[k] = Select(lanes, Real(0.0f), Real(turned[k]));
}

}  // namespace fulcrum::joints
