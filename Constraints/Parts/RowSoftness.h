// Soft constraints: the coefficients, independent of the mass, that contacts, locks, limits and springs share, and the
// change of impulse that follows from them. Free functions and plain data, no threads.
//
// With K = J M^-1 J^T, C the error, h the substep, gamma the softness and b the velocity bias, a soft row solves
//     J v + b + beta C + gamma lambda = 0,    delta lambda = -(J v + b + beta C + gamma lambda) / (K + gamma)
// Written with K^-1, the effective mass, that is
//     delta lambda = -(K^-1 massScale (J v + b + beta C) + impulseScale lambda),
//     massScale = K / (K + gamma),  impulseScale = gamma / (K + gamma),  massScale + impulseScale = 1.
// (1, 0) is the hard row. For a spring k and damper c, gamma = 1 / (h (c + h k)) and beta = h k gamma; with k = m w^2,
// c = 2 m zeta w and m = 1 / K, none of the three depends on the mass:
//     a = K / gamma = h w (2 zeta + h w),  massScale = a / (1 + a),  impulseScale = 1 / (1 + a),  beta = w / (2 zeta +
//     h w).
// Sources: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D"; E. Catto, "Soft Constraints", GDC
// 2011, and "Solver2D", 2024.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// Both 0..1.
template <class Real>
struct RowSoftness {
    Real massScale = Real(1.0f);
    Real impulseScale = Real(0.0f);
};

// From a = K / gamma >= 0.
template <class Real>
inline RowSoftness<Real> SoftnessOf(const Real& a) {
    const Real one(1.0f);
    return {a / (one + a), one / (one + a)};
}

// Softness and rate of error correction: pushRate is beta, 1/s.
struct PushSoftness {
    float pushRate;
    RowSoftness<float> softness;
};
// frequency: Hz, > 0; dampingRatio >= 0; h: s, > 0.
inline PushSoftness PushSoftnessOf(float frequency, float dampingRatio, float h) {
    const float w = 6.28318531f * frequency;
    return {w / (2.0f * dampingRatio + h * w), SoftnessOf(h * w * (2.0f * dampingRatio + h * w))};
}

// delta lambda of rows whose K^-1 massScale (J v + b) is `impulse`.
template <class Real, class Rows>
FULCRUM_FORCE_INLINE Rows SoftDelta(const Rows& impulse, const Rows& totalLambda, const Real& impulseScale) {
    return -(impulse + totalLambda * impulseScale);
}

}  // namespace fulcrum
