// Softness of a spring's row, such that the row alone gives the map v' = (v - Kx C / h) / D of SpringSettings.h (Kx is
// its K). In the coefficients of RowSoftness.h,
//     massScale = 1 - 1/D,  impulseScale = 1/D,  beta = Kx / (h (D - 1)).
// beta is infinite where nothing damps (D = 1), so it is kept multiplied by massScale: Kx / (D h), finite whatever the
// spring. Free functions, no threads.
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

// Of the map in SpringSettings.h: 1 - 1/D and 1/D, and Kx/D.
template <class Real>
struct SpringGains {
    RowSoftness<Real> softness;
    Real errorGain = Real(0.0f);
};

// a = zeta w h >= 0, squaredAngle = (w h)^2 > 0. All terms are decaying exponentials and sums of terms of one sign: no
// overflow, no cancellation. For automatic, D is raised until D - 1 >= K / 2.
inline SpringGains<float> ExactSpringGains(float squaredAngle, float a, bool automatic) {
    const float discriminant = squaredAngle - a * a;
    if (discriminant < 0.0f) {
        const float angle = Sqrt(-discriminant);
        const float fast = a + angle;
        return {{OneMinusExp(2.0f * a), Exp(-2.0f * a)}, OneMinusExp(squaredAngle / fast) * OneMinusExp(fast)};
    }
    const float angle = Sqrt(discriminant);
    const float halfSine = Sin(0.5f * angle);
    const float twoHalfSineSquared = 2.0f * halfSine * halfSine;  // 1 - cos
    float rootLoss = OneMinusExp(a);                              // 1 - 1 / sqrt(D)
    if (automatic) {
        // sqrt(D) = sqrt(3 + cos^2) - cos is where D - 1 = K / 2; minus 1 it is 2 (1 - cos) / (sqrt(3 + cos^2) + 1 +
        // cos).
        const float cosine = 1.0f - twoHalfSineSquared;
        const float least = 2.0f * twoHalfSineSquared / (Sqrt(3.0f + cosine * cosine) + 1.0f + cosine);
        rootLoss = Max(rootLoss, least / (1.0f + least));
    }
    const float root = 1.0f - rootLoss;
    return {{rootLoss * (1.0f + root), root * root}, rootLoss * rootLoss + 2.0f * root * twoHalfSineSquared};
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

// Coefficients of a spring's row: its softness, and errorRate = massScale beta, 1/s.
template <class Real>
struct SpringSoftness {
    RowSoftness<Real> softness;
    Real errorRate = Real(0.0f);
};

// dt > 0, s; inverseEffectiveMass: K, 1/kg or 1/(kg m2). The constants come from spring settings, from a frequency and
// damping ratio, or from a stiffness and damping (SpringSettings.h). Lanes without stiffness are hard.
template <class Real>
inline SpringSoftness<Real> SpringSoftnessOf(Real dt, Real inverseEffectiveMass, const SpringConstants<Real>& spring) {
    using namespace detail;
    // Stiffer than any spring that differs from a hard row in float precision, and far from overflow.
    const Real largest(1e18f);
    const Real one(1.0f);
    const Real squaredOmega = spring.squaredFrequency + spring.stiffness * inverseEffectiveMass;
    const Real decayRate = spring.decayRate + spring.damping * inverseEffectiveMass;
    const Real squaredAngle = Min(squaredOmega * dt * dt, largest);
    const Real twiceDecay = Min(decayRate * dt, largest);
    const Real excess = twiceDecay + squaredAngle;  // D - 1 of the implicit form
    SpringGains<Real> gains;
    gains.softness = SoftnessOf(excess);
    gains.errorGain = squaredAngle * gains.softness.impulseScale;

    for (int lane = 0; lane < kLaneCount<Real>; ++lane) {
        const float form = LaneOf(spring.form, lane);
        const float w2 = LaneOf(squaredAngle, lane), a = 0.5f * LaneOf(twiceDecay, lane);
        const bool automatic = form == static_cast<float>(SpringForm::Automatic);
        constexpr float kSquaredPi = 9.8696044f;
        const bool exact = automatic ? w2 <= 1.0f && 2.0f * a * a < w2
                                     : form == static_cast<float>(SpringForm::Exact) && w2 - a * a < kSquaredPi;
        if (!exact || !(w2 > 0.0f)) continue;
        const SpringGains<float> laneGains = ExactSpringGains(w2, a, automatic);
        SetLaneOf(gains.softness.massScale, lane, laneGains.softness.massScale);
        SetLaneOf(gains.softness.impulseScale, lane, laneGains.softness.impulseScale);
        SetLaneOf(gains.errorGain, lane, laneGains.errorGain);
    }
    const auto soft = squaredOmega > Real(0.0f);
    gains.softness.massScale = Select(soft, gains.softness.massScale, one);
    gains.softness.impulseScale = Select(soft, gains.softness.impulseScale, Real(0.0f));
    return {gains.softness, Select(soft, gains.errorGain / dt, Real(0.0f))};
}

}  // namespace fulcrum
