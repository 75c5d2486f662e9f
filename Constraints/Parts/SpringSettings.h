// A user's spring settings of a constraint, and the constants that a row derives from them. Validated once when a joint
// is created; SpringSoftness.h turns the constants into the softness of a row. Plain data, no threads.
//
// A soft row that acts alone on a mass with error x maps its velocity, once per substep of length h, as
//     v' = (v - K x / h) / D,    x' = x + h v'
// and D and K decide which oscillator x'' + 2 zeta w x' + w^2 x = 0 that is. With a = zeta w h and W = (w h)^2:
//     Implicit:  D = 1 + 2 a + W,  K = W
//                damping added at every step: zeta grows by about w h / 2
//     Exact:     D = e^(2a),       K = 1 + D - 2 sqrt(D) cos(sqrt(W - a^2)), or cosh(sqrt(a^2 - W)) where a^2 > W
//                the eigenvalues of the oscillator itself, so x is that of the continuum at every step
// What each costs:
//  - A constant load F rests at x = F h^2 / (m K): implicit meets F / k, exact is too stiff by about the factor 1 + a.
//    Implicit is off by w h / (2 zeta) of the damping ratio instead; the two errors are equal at zeta = 1 / sqrt(2).
//  - With E = sum(m v^2 + m K x^2 / h^2) / 2 over all rows that share bodies, a converged step changes E by at most
//    -sum m v'^2 (D - 1 - K / 2). Where D - 1 >= K / 2 no system of rows can gain energy, whatever masses meet.
//    Implicit always satisfies that, exact does not once w h > 4 zeta or so: several such springs on one body can blow
//    up.
// Automatic, the default, therefore takes for frequency and damping ratio the exact form where it is the better one
// (zeta < 1 / sqrt(2)) and a period has six steps or more (w h <= 1, where it is stable with a single iteration too),
// with D raised to the bound D - 1 = K / 2 where it is below (zeta then acts as w h / 4, the frequency stays exact);
// elsewhere implicit. Stiffness and damping state a force law, not a motion: there Automatic is implicit, whose force
// at rest is k x. Source of the implicit form: E. Catto, "Soft Constraints", GDC 2011.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Math/Wide.h>

#include <cstdint>

namespace fulcrum {

enum class SpringMode : uint8_t {
    FrequencyAndDamping,  // stiffness and damping are derived from the row's effective mass
    StiffnessAndDamping,  // the force law F = -k x - c v
};

enum class SpringForm : uint8_t {
    Automatic,  // see above
    Exact,      // the continuous oscillator wherever it has more than two steps a period (else implicit)
    Implicit,   // unconditionally stable, exact at rest, over-damped by about w h / 2
};

// Frequency 0 and stiffness 0 both mean a hard constraint.
struct SpringSettings {
    SpringMode mode = SpringMode::FrequencyAndDamping;
    float frequency = 0.0f;     // Hz, >= 0; of the undamped oscillation
    float dampingRatio = 0.0f;  // >= 0; 0 none, 1 critical
    float stiffness = 0.0f;     // N/m or N m/rad, >= 0; used by StiffnessAndDamping
    float damping = 0.0f;       // N s/m or N m s/rad, >= 0; used by StiffnessAndDamping
    SpringForm form = SpringForm::Automatic;
};

// Errors: NonFinite, Negative, OutOfRange, naming the field. Every field is checked, used by the mode or not.
Status Validate(const SpringSettings& settings);

// The constants of a row. With K the inverse effective mass: w^2 = squaredFrequency + stiffness K and
// 2 zeta w = decayRate + damping K; either the first or the second term of each is zero. Hard where w = 0.
template <class Real>
struct SpringConstants {
    Real squaredFrequency = Real(0.0f);  // rad^2/s^2
    Real decayRate = Real(0.0f);         // 1/s
    Real stiffness = Real(0.0f);         // N/m
    Real damping = Real(0.0f);           // N s/m
    Real form = Real(0.0f);              // SpringForm as a number, so that lanes may differ
};

// From a frequency (Hz) and damping ratio, and from a stiffness (N/m, N m/rad) and damping (N s/m, N m s/rad). All >=
// 0. A force law is implicit by default.
template <class Real>
inline SpringConstants<Real> FrequencyConstants(Real frequency, Real dampingRatio,
                                                SpringForm form = SpringForm::Automatic) {
    // Bounded so that its square is finite: no row is stiffer than hard.
    const Real omega = Min(Real(6.28318530718f) * frequency, Real(1e19f));
    SpringConstants<Real> constants;
    constants.squaredFrequency = omega * omega;
    constants.decayRate = Real(2.0f) * dampingRatio * omega;
    constants.form = Real(static_cast<float>(form));
    return constants;
}
template <class Real>
inline SpringConstants<Real> StiffnessConstants(Real stiffness, Real damping, SpringForm form = SpringForm::Automatic) {
    SpringConstants<Real> constants;
    constants.stiffness = stiffness;
    constants.damping = damping;
    constants.form = Real(static_cast<float>(form == SpringForm::Automatic ? SpringForm::Implicit : form));
    return constants;
}
// Settings must be valid.
inline SpringConstants<float> ToConstants(const SpringSettings& settings) {
    if (settings.mode == SpringMode::StiffnessAndDamping)
        return StiffnessConstants(settings.stiffness, settings.damping, settings.form);
    return FrequencyConstants(settings.frequency, settings.dampingRatio, settings.form);
}

}  // namespace fulcrum
