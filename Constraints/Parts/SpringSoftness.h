// Softness of a spring's row, such that the row alone gives the map v' = (v - L v0 - Kx C / h) / D of SpringSettings.h
// (Kx is its K). In the coefficients of RowSoftness.h,
//     massScale = 1 - 1/D,  impulseScale = 1/D,  b + beta C = (L v0 + Kx C / h) / (D - 1).
// The last is kept multiplied by massScale: (L v0 + Kx C / h) / D, finite whatever the spring. Free functions, no
// threads.
#pragma once

#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/Parts/SpringSettings.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <type_traits>

namespace fulcrum {

namespace detail {

// 1 - e^-x for x >= 0, without the cancellation that 1 - Exp(-x) has for small x.
inline float OneMinusExp(float x) {
    if (x > 0.5f) return 1.0f - Exp(-x);
    // The Taylor series up to x^8, nested; the next term is below 2e-8 of the result.
    float sum = 1.0f - x * (1.0f / 8.0f);
    for (const float inverse : {1.0f / 7.0f, 1.0f / 6.0f, 1.0f / 5.0f, 1.0f / 4.0f, 1.0f / 3.0f, 1.0f / 2.0f})
        sum = 1.0f - x * inverse * sum;
    return x * sum;
}

// Of the map in SpringSettings.h: 1 - 1/D and 1/D, K/D and L/D.
template <class Real>
struct SpringGains {
    RowSoftness<Real> softness;
    Real errorGain = Real(0.0f), speedGain = Real(0.0f);
};

// Rows divide by their massScale, so that none is 0. Far below what a motion shows, far above rounding.
inline constexpr float kLeastMassScale = 1.0f / (1 << 17);
// Of SpringForm::Automatic: shares of what may be taken from the kinetic energy before a system can gain any. Up to the
// first a spring is as it should be: alone it has six steps a period then. From the second on it is implicit.
inline constexpr float kSoundShare = 0.25f, kLargestShare = 0.5f;

// a = zeta w h >= 0, squaredAngle = (w h)^2 > 0, for w h sqrt(1 - zeta^2) < pi. All terms are decaying exponentials and
// sums of terms of one sign: no overflow, no cancellation. isLaw: at rest the force is that of the stiffness.
inline SpringGains<float> ExactSpringGains(float squaredAngle, float a, bool isLaw) {
    const float rootLoss = OneMinusExp(a), root = 1.0f - rootLoss;  // 1 - e^-a, e^-a
    const float discriminant = squaredAngle - a * a;
    float errorGain = 0.0f;
    if (discriminant < 0.0f) {
        const float fast = a + Sqrt(-discriminant);
        errorGain = OneMinusExp(squaredAngle / fast) * OneMinusExp(fast);
    } else {
        const float halfSine = Sin(0.5f * Sqrt(discriminant));
        errorGain = rootLoss * rootLoss + 4.0f * root * halfSine * halfSine;
    }
    // D is e^a, or less where the spring would be too stiff at rest.
    const float atRest = errorGain / squaredAngle;
    const bool isStiff = atRest > root;
    const float massScale = Max(isStiff ? 1.0f - atRest : rootLoss, kLeastMassScale);
    const float speedGain = rootLoss * (1.0f + root) - massScale;
    if (isLaw && !isStiff) errorGain = squaredAngle * (1.0f - massScale);
    return {{massScale, 1.0f - massScale}, errorGain, speedGain};
}

// The same, and implicit as far as springs of one body, `coupled` of them, would take too much of its kinetic energy.
inline SpringGains<float> AutomaticSpringGains(float squaredAngle, float a, bool isLaw, float coupled,
                                               const SpringGains<float>& implicit) {
    constexpr float kSquaredRightAngle = 2.4674011f;  // there half the kinetic energy is taken
    if (squaredAngle > kSquaredRightAngle) return implicit;
    const SpringGains<float> exact = ExactSpringGains(squaredAngle, a, isLaw);
    // The sums over springs of their shares, and of L, which turns velocities around where it is more than 2.
    const float perD = coupled / exact.softness.impulseScale,
                taken = 0.25f * exact.errorGain - 0.5f * (exact.softness.massScale - exact.speedGain);
    const float halfSine = Sin(0.5f * Sqrt(squaredAngle));
    const float share = Max(perD * Max(taken, exact.speedGain * (0.5f * kSoundShare)), halfSine * halfSine);
    if (share <= kSoundShare) return exact;
    const float part = Min((share - kSoundShare) / (kLargestShare - kSoundShare), 1.0f);
    // D, K and L are blended. Both D are finite.
    const float ofImplicit = part * exact.softness.impulseScale,
                ofExact = (1.0f - part) * implicit.softness.impulseScale;
    if (!(ofExact > 0.0f)) return implicit;
    const float i = ofImplicit / (ofImplicit + ofExact), e = ofExact / (ofImplicit + ofExact);
    return {{e * exact.softness.massScale + i * implicit.softness.massScale,
             e * exact.softness.impulseScale + i * implicit.softness.impulseScale},
            e * exact.errorGain + i * implicit.errorGain,
            e * exact.speedGain};
}

inline float LaneOf(float x, int) { return x; }
inline void SetLaneOf(float& x, int, float value) { x = value; }
template <int N>
inline float LaneOf(const Wide<N>& x, int lane) {
    return x[lane];
}
template <int N>
inline void SetLaneOf(Wide<N>& x, int lane, float value) {
    x.Set(lane, value);
}
template <class Real>
inline constexpr int kLaneCount = sizeof(Real) / sizeof(float);

}  // namespace detail

// Coefficients of a spring's row: its softness, errorRate = massScale beta, 1/s, and the part of J v at the start of
// the substep that is in its bias.
template <class Real>
struct SpringSoftness {
    RowSoftness<Real> softness;
    Real errorRate = Real(0.0f), speedPart = Real(0.0f);
};

// dt > 0, s; inverseEffectiveMass: K, 1/kg or 1/(kg m2). The constants come from spring settings, from a frequency and
// damping ratio, or from a stiffness and damping (SpringSettings.h). coupled: springs that act on one body along the
// same way, this one included. Lanes without stiffness are hard.
template <class Real>
inline SpringSoftness<Real> SpringSoftnessOf(Real dt, Real inverseEffectiveMass, const SpringConstants<Real>& spring,
                                             Real coupled = Real(1.0f)) {
    using namespace detail;
    // Stiffer than any spring that differs from a hard row in float precision, and far from overflow.
    const Real largest(1e18f);
    const Real one(1.0f), zero(0.0f);
    const Real squaredOmega = spring.squaredFrequency + spring.stiffness * inverseEffectiveMass;
    const Real decayRate = spring.decayRate + spring.damping * inverseEffectiveMass;
    const Real squaredAngle = Min(squaredOmega * dt * dt, largest);
    const Real twiceDecay = Min(decayRate * dt, largest);
    const Real excess = twiceDecay + squaredAngle;  // D - 1 of the implicit form
    SpringGains<Real> gains;
    gains.softness = SoftnessOf(excess);
    gains.errorGain = squaredAngle * gains.softness.impulseScale;

    for (int lane = 0; lane < kLaneCount<Real>; ++lane) {
        const auto form = static_cast<SpringForm>(static_cast<int>(LaneOf(spring.form, lane)));
        const float w2 = LaneOf(squaredAngle, lane), a = 0.5f * LaneOf(twiceDecay, lane);
        constexpr float kSquaredPi = 9.8696044f;
        if (form == SpringForm::Implicit || !(w2 > 0.0f) || w2 - a * a >= kSquaredPi) continue;
        const bool isLaw = LaneOf(spring.stiffness, lane) > 0.0f;
        const SpringGains<float> implicit{
            {LaneOf(gains.softness.massScale, lane), LaneOf(gains.softness.impulseScale, lane)},
            LaneOf(gains.errorGain, lane)};
        const SpringGains<float> laneGains = form == SpringForm::Exact
                                                 ? ExactSpringGains(w2, a, false)
                                                 : AutomaticSpringGains(w2, a, isLaw, LaneOf(coupled, lane), implicit);
        SetLaneOf(gains.softness.massScale, lane, laneGains.softness.massScale);
        SetLaneOf(gains.softness.impulseScale, lane, laneGains.softness.impulseScale);
        SetLaneOf(gains.errorGain, lane, laneGains.errorGain);
        SetLaneOf(gains.speedGain, lane, laneGains.speedGain);
    }
    const auto soft = squaredOmega > zero;
    gains.softness.massScale = Select(soft, gains.softness.massScale, one);
    gains.softness.impulseScale = Select(soft, gains.softness.impulseScale, zero);
    return {gains.softness, Select(soft, gains.errorGain / dt, zero), Select(soft, gains.speedGain, zero)};
}

}  // namespace fulcrum
