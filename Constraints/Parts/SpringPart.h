// The scalar half of a one-row part: effective mass, velocity bias and softness, hard or soft. Axis and angle parts are
// made of a Jacobian and of this. No state beyond its own; one thread per part.
//
// Hard: delta lambda = -m (J v + b), with m = 1 / K and K = J M^-1 J^T.
// Soft, with gamma the softness, C the error and h the substep (Chappuis; Catto, "Soft Constraints", GDC 2011):
//     delta lambda = -(J v + b + beta C + gamma lambda) / (K + gamma)
// Solved alone it gives v' = (v - beta C K / gamma) gamma / (K + gamma): the map v' = (v - Kx C / h) / D of
// SpringSettings.h (Kx is its K) with
//     gamma = K / (D - 1),    beta = Kx / (h (D - 1)).
// For the implicit form, D - 1 = h K (c + h k), that is gamma = 1 / (h (c + h k)) and beta = h k gamma.
// Both are infinite where nothing damps (D = 1), so the row is kept multiplied through by the softened mass
// 1 / (K + gamma) = m (1 - 1/D):
//     delta lambda = -(m (1 - 1/D) J v  +  m ((1 - 1/D) b + Kx C / (D h))  +  lambda / D)
// Three finite numbers, whatever the spring; 1/D = 0 is the hard row.
#pragma once

#include <Fulcrum/Constraints/Parts/BodySide.h>
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

// 1 - 1/D, 1/D and K/D of the map in SpringSettings.h.
template <class Real>
struct SpringGains {
    Real massScale = Real(1.0f);
    Real softness = Real(0.0f);
    Real errorGain = Real(0.0f);
};

// a = zeta w h >= 0, squaredAngle = (w h)^2 > 0. Every term is a decaying exponential and a sum of what has one sign:
// nothing overflows and nothing cancels. For automatic, D is raised until D - 1 >= K / 2.
inline SpringGains<float> ExactSpringGains(float squaredAngle, float a, bool automatic) {
    const float discriminant = squaredAngle - a * a;
    if (discriminant < 0.0f) {
        const float angle = Sqrt(-discriminant);
        const float fast = a + angle;
        return {OneMinusExp(2.0f * a), Exp(-2.0f * a), OneMinusExp(squaredAngle / fast) * OneMinusExp(fast)};
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
    return {rootLoss * (1.0f + root), root * root, rootLoss * rootLoss + 2.0f * root * twoHalfSineSquared};
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

// dt > 0. Hard lanes (no stiffness) get the gains of a hard row.
template <class Real>
inline SpringGains<Real> CalculateSpringGains(Real dt, Real inverseEffectiveMass, const SpringConstants<Real>& spring) {
    // Far beyond any spring that differs from a hard row, and far from overflow.
    const Real largest(1e18f);
    const Real one(1.0f);
    const Real squaredOmega = spring.squaredFrequency + spring.stiffness * inverseEffectiveMass;
    const Real decayRate = spring.decayRate + spring.damping * inverseEffectiveMass;
    const Real squaredAngle = Min(squaredOmega * dt * dt, largest);
    const Real twiceDecay = Min(decayRate * dt, largest);
    const Real excess = twiceDecay + squaredAngle;  // D - 1 of the implicit form
    SpringGains<Real> gains;
    gains.softness = one / (one + excess);
    gains.massScale = excess * gains.softness;
    gains.errorGain = squaredAngle * gains.softness;

    for (int lane = 0; lane < kLaneCount<Real>; ++lane) {
        const float form = LaneOf(spring.form, lane);
        const float w2 = LaneOf(squaredAngle, lane), a = 0.5f * LaneOf(twiceDecay, lane);
        const bool automatic = form == static_cast<float>(SpringForm::Automatic);
        constexpr float kSquaredPi = 9.8696044f;
        const bool exact = automatic ? w2 <= 1.0f && 2.0f * a * a < w2
                                     : form == static_cast<float>(SpringForm::Exact) && w2 - a * a < kSquaredPi;
        if (!exact || !(w2 > 0.0f)) continue;
        const SpringGains<float> laneGains = ExactSpringGains(w2, a, automatic);
        SetLaneOf(gains.massScale, lane, laneGains.massScale);
        SetLaneOf(gains.softness, lane, laneGains.softness);
        SetLaneOf(gains.errorGain, lane, laneGains.errorGain);
    }
    const auto soft = squaredOmega > Real(0.0f);
    gains.massScale = Select(soft, gains.massScale, one);
    gains.softness = Select(soft, gains.softness, Real(0.0f));
    gains.errorGain = Select(soft, gains.errorGain, Real(0.0f));
    return gains;
}

struct Nothing {};

}  // namespace detail

// What a snapshot keeps of a row.
template <class Real>
struct RowState {
    Real totalLambda = Real(0.0f);
};

// kSoft false: a row that is always hard, one number smaller and one product per solve cheaper.
template <class Real, bool kSoft = true>
class SpringPart {
public:
    using Mask = MaskOf<Real>;

    // inverseEffectiveMass: K >= 0; where it is zero (no body can move) the row is inactive.
    // bias: b of J v + b = 0, m/s or rad/s.
    void SetHard(Real inverseEffectiveMass, Real bias) {
        effectiveMass_ = EffectiveMass(inverseEffectiveMass);
        biasImpulse_ = effectiveMass_ * bias;
        if constexpr (kSoft) softness_ = Real(0.0f);
    }

    // Soft as the constants say. dt > 0; error: C, m or rad.
    void SetSoft(Real dt, Real inverseEffectiveMass, Real bias, Real error,
                 const SpringConstants<Real>& spring) requires kSoft {
        const detail::SpringGains<Real> gains = detail::CalculateSpringGains(dt, inverseEffectiveMass, spring);
        const Real mass = EffectiveMass(inverseEffectiveMass);
        effectiveMass_ = mass * gains.massScale;
        biasImpulse_ = mass * (gains.massScale * bias + gains.errorGain * error / dt);
        softness_ = Select(mass > Real(0.0f), gains.softness, Real(0.0f));
    }

    // Another bias for a hard row that is otherwise as it was set up.
    void SetBias(Real bias) { biasImpulse_ = effectiveMass_ * bias; }

    void Deactivate() {
        effectiveMass_ = Real(0.0f);
        biasImpulse_ = Real(0.0f);
        if constexpr (kSoft) softness_ = Real(0.0f);
    }
    // The lanes that `mask` names.
    void Deactivate(Mask mask) {
        effectiveMass_ = Select(mask, Real(0.0f), effectiveMass_);
        biasImpulse_ = Select(mask, Real(0.0f), biasImpulse_);
        if constexpr (kSoft) softness_ = Select(mask, Real(0.0f), softness_);
    }

    // A spring without damping has no softened mass but acts: its force is explicit.
    Mask IsActive() const {
        if constexpr (kSoft) return (effectiveMass_ > Real(0.0f)) | (softness_ > Real(0.0f));
        else return effectiveMass_ > Real(0.0f);
    }
    Mask IsHard() const {
        if constexpr (kSoft) return (effectiveMass_ > Real(0.0f)) & (softness_ <= Real(0.0f));
        else return effectiveMass_ > Real(0.0f);
    }

    // kg or kg m2; of a soft row softened. Zero where the row is inactive.
    Real GetEffectiveMass() const { return effectiveMass_; }

    // The total impulse after a solve without limits, from J v and the total impulse before.
    Real SolveTotalLambda(Real relativeVelocity, Real totalLambda) const {
        const Real impulse = effectiveMass_ * relativeVelocity + biasImpulse_;
        if constexpr (kSoft) return totalLambda - (impulse + softness_ * totalLambda);
        else return totalLambda - impulse;
    }

private:
    static Real EffectiveMass(Real inverseEffectiveMass) {
        const Mask movable = inverseEffectiveMass > Real(0.0f);
        return Select(movable, Real(1.0f) / Select(movable, inverseEffectiveMass, Real(1.0f)), Real(0.0f));
    }

    Real effectiveMass_ = Real(0.0f);
    Real biasImpulse_ = Real(0.0f);
    [[no_unique_address]] std::conditional_t<kSoft, Real, detail::Nothing> softness_ = {};
};

}  // namespace fulcrum
