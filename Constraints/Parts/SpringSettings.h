// A user's spring settings of a constraint, and the constants that a row derives from them. Validated once when a joint
// is created; SpringSoftness.h turns the constants into the softness of a row. Plain data, no threads.
//
// A spring's row that acts alone on a mass with error x maps its velocity, once per substep of length h, as
//     v' = (v - L v0 - K x / h) / D,    x' = x + h v'
// v0 being the velocity at the start of the substep, v that with the changes by other forces. The force is
//     -((D - 1) v' + L v0 + K x / h) m / h
// Eigenvalues p, q of the map without other forces belong to the oscillator x'' + 2 zeta w x' + w^2 x = 0 if, with
// a = zeta w h, W = (w h)^2 and t = sqrt(W - a^2) (cosh of sqrt(a^2 - W) for its cosine where zeta > 1),
//     p q = (1 - L) / D = e^(-2a),    p + q = (1 - L + D - K) / D = 2 e^-a cos(t)
// D is free: K / D = 1 + e^(-2a) - 2 e^-a cos(t) and L = 1 - D e^(-2a) follow from it. The forms:
//     Implicit:   D = 1 + 2 a + W, K = W, L = 0: not that oscillator, zeta grows by about w h / 2
//     Exact:      D = e^a, where the map is symmetric in time: K = 2 cosh(a) - 2 cos(t), L = 1 - e^-a. Nothing damps an
//                 undamped spring, whose force does not depend on iterations (D = 1). A constant load F rests at
//                 F h^2 / (m K), up to W / 12 farther than F / k. With zeta > 1 / sqrt(2) K would exceed W: there it is
//                 W, as it is of the force, and D follows: the load rests at F / k
// Several rows that share bodies: with the errors at the middle of the last substep, x - h v / 2, the sum
//     E = sum m v^2 / 2 - sum (K / 4 - (D - 1 - L) / 2) m v^2 / 2 + sum m K (x - h v / 2)^2 / 2 h^2
// over bodies and rows changes in a converged substep by -sum (D - 1 + L) m (v + v0)^2 / 4, m being the rows' masses:
// it never rises. It bounds the motion as long as the second sum takes less than the first, kinetic energy. Implicit
// rows take nothing, so that no system of them gains energy. Of an undamped spring that is exact the share is sin^2(w h
// / 2), of n springs along one way of a body up to n times as much.
//
// Automatic, the default, is exact where that share is at most a quarter: alone at six steps a period or more, as one
// of four springs at twelve or more. Where it is more than half, as at less than four steps a period, it is implicit,
// and damps more than its settings say; between the two it changes from one to the other. With damping of 1 / sqrt(2)
// and more nothing is taken; the number of springs counts only where they would turn velocities around (sum of L above
// 2). Stiffness and damping state a force law: there K = W, so that the force at rest is k x, and the undamped
// frequency is too high by a part of W / 24. Springs that are much stiffer than the substep and contradict each other
// gain what iterations leave unsolved of them, as implicit ones do.
//
// Sources: of the implicit form E. Catto, "Soft Constraints", GDC 2011; of the exact one without damping, the leapfrog
// method with another stiffness, R. E. Mickens, "Nonstandard Finite Difference Models of Differential Equations", 1994.
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
    Automatic,  // the continuous oscillator where it has six steps a period or more, else implicit; see above
    Exact,      // the continuous oscillator wherever it has more than two steps a period (else implicit); several such
                // springs on a body may gain energy
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
// 0.
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
    constants.form = Real(static_cast<float>(form));
    return constants;
}
// Settings must be valid.
inline SpringConstants<float> ToConstants(const SpringSettings& settings) {
    if (settings.mode == SpringMode::StiffnessAndDamping)
        return StiffnessConstants(settings.stiffness, settings.damping, settings.form);
    return FrequencyConstants(settings.frequency, settings.dampingRatio, settings.form);
}

}  // namespace fulcrum
