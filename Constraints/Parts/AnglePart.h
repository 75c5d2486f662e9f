// One row that limits the rotation of two bodies about an axis: twist friction, hinge limits and motors. Called by
// contacts and joints, which gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (hinge limits).
//   theta  angle of body 2 against body 1 about a         a  unit axis, world space
//   Constraint:  C = theta - theta_min
//   Derivative:  dC/dt = a . (w2 - w1)
//   Jacobian:    J = [0, -a, 0, a]
//   K = J M^-1 J^T = a . I1^-1 a + a . I2^-1 a
//   A solve changes the angular impulse by delta lambda = -K^-1 (J v + b) (soft: SpringPart.h), clamps the total to its
//   limits and adds M^-1 J^T delta lambda to the velocities.
//
// As in the axis part, the axis and the masses are handed in again at every call and must be those of the set-up.
#pragma once

#include <Fulcrum/Constraints/Parts/SpringPart.h>

namespace fulcrum {

// Real: float, or Wide<N> for N constraints; both give the same bits. kSoft false: a row that is never a spring.
// Only the angular halves of twists, and the inertia of masses, are read and written.
template <class Real, bool kSoft = true>
class AnglePart {
public:
    using Mask = MaskOf<Real>;
    using Vector = Vec3<Real>;
    using State = RowState<Real>;

    // Set-up, once per substep. Leaves the total impulse for the warm start, but zero where the row is inactive.
    // bias: b, rad/s. The solve reaches J v = -b.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vector& axis,
                             Real bias) {
        spring_.SetHard(InverseEffectiveMass<kSide1, kSide2>(mass1, mass2, axis), bias);
        ForgetInactive();
    }
    // Soft. dt > 0, s; error: C, rad; the constants come from ToConstants of valid SpringSettings. Hard where those are
    // zero.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateSpringProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                   const Vector& axis, Real bias, Real error,
                                   const SpringConstants<Real>& spring) requires kSoft {
        spring_.SetSoft(dt, InverseEffectiveMass<kSide1, kSide2>(mass1, mass2, axis), bias, error, spring);
        ForgetInactive();
    }
    // The same for one constraint, from its settings, from a frequency (Hz) and damping ratio, or from a stiffness
    // (N m/rad) and damping (N m s/rad), all >= 0.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateSpringProperties(float dt, const InverseMass<float>& mass1, const InverseMass<float>& mass2,
                                   const Vec3<float>& axis, float bias, float error,
                                   const SpringSettings& settings) requires(kSoft&& std::is_same_v<Real, float>) {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, axis, bias, error, ToConstants(settings));
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateFrequencyProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                      const Vector& axis, Real bias, Real error, Real frequency,
                                      Real dampingRatio) requires kSoft {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, axis, bias, error,
                                                  FrequencyConstants(frequency, dampingRatio));
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateStiffnessProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                      const Vector& axis, Real bias, Real error, Real stiffness,
                                      Real damping) requires kSoft {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, axis, bias, error,
                                                  StiffnessConstants(stiffness, damping));
    }

    // Another bias (rad/s) for a hard row that is otherwise as it was set up.
    void SetBias(Real bias) { spring_.SetBias(bias); }

    void Deactivate() {
        spring_.Deactivate();
        totalLambda_ = Real(0.0f);
    }
    void Deactivate(Mask mask) {
        spring_.Deactivate(mask);
        ForgetInactive();
    }
    Mask IsActive() const { return spring_.IsActive(); }

    // Applies the impulse of the step before, scaled by dt / dt of that step.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void WarmStart(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                   const InverseMass<Real>& mass2, const Vector& axis, Real dtRatio) {
        totalLambda_ = Select(IsActive(), totalLambda_ * dtRatio, Real(0.0f));
        ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, axis, totalLambda_);
    }

    // One iteration; the total impulse stays in [minLambda, maxLambda], N m s. Returns where anything was applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Vector& axis, Real minLambda, Real maxLambda) {
        const Real relativeVelocity = RelativeMotion<kSide1, kSide2>(velocity1, velocity2, axis);
        const Real totalLambda = Clamp(spring_.SolveTotalLambda(relativeVelocity, totalLambda_), minLambda, maxLambda);
        const Real deltaLambda = Select(IsActive(), totalLambda - totalLambda_, Real(0.0f));
        const Mask applied = ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, axis, deltaLambda);
        totalLambda_ = Select(applied, totalLambda, totalLambda_);
        return applied;
    }

    // One position pass: turns the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J.
    // error: C as the poses are now, rad; zero where it is satisfied. Springs are left alone: their error is their
    // torque.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Vector& axis, Real error, Real baumgarte) const {
        const Real lambda = -(spring_.GetEffectiveMass() * baumgarte * error);
        return ApplyImpulse<kSide1, kSide2>(displacement1, displacement2, mass1, mass2, axis,
                                            Select(spring_.IsHard(), lambda, Real(0.0f)));
    }

    // J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2, const Vector& axis) const {
        if constexpr (HasVelocity(kSide1) && HasVelocity(kSide2)) {
            const Vector angular = motion2.angular - motion1.angular;
            return Dot<Real>(axis, angular);
        } else if constexpr (HasVelocity(kSide2)) {
            return Dot<Real>(axis, motion2.angular);
        } else if constexpr (HasVelocity(kSide1)) {
            return -Dot<Real>(axis, motion1.angular);
        } else {
            return Real(0.0f);
        }
    }

    // N m s.
    Real GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(Real totalLambda) { totalLambda_ = totalLambda; }
    // Softened for a spring; zero where inactive. kg m2.
    Real GetEffectiveMass() const { return spring_.GetEffectiveMass(); }

    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

private:
    template <BodySide kSide1, BodySide kSide2>
    static Real InverseEffectiveMass(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                     const Vector& axis) {
        Real sum1(0.0f), sum2(0.0f);
        if constexpr (HasMass(kSide1)) sum1 = Dot<Real>(axis, mass1.inertia * axis);
        if constexpr (HasMass(kSide2)) sum2 = Dot<Real>(axis, mass2.inertia * axis);
        return sum1 + sum2;
    }

    // Adds M^-1 J^T lambda where lambda is not zero; NaN counts as zero, so that one bad constraint spoils no body.
    template <BodySide kSide1, BodySide kSide2>
    static Mask ApplyImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                             const InverseMass<Real>& mass2, const Vector& axis, Real lambda) {
        const Mask applied = (lambda < Real(0.0f)) | (lambda > Real(0.0f));
        if constexpr (HasMass(kSide1)) {
            const Vector angular = (mass1.inertia * axis) * lambda;
            motion1.angular -= ZeroUnless<Real>(applied, angular);
        }
        if constexpr (HasMass(kSide2)) {
            const Vector angular = (mass2.inertia * axis) * -lambda;
            motion2.angular -= ZeroUnless<Real>(applied, angular);
        }
        return applied;
    }

    void ForgetInactive() { totalLambda_ = Select(IsActive(), totalLambda_, Real(0.0f)); }

    SpringPart<Real, kSoft> spring_;
    Real totalLambda_ = Real(0.0f);
};

}  // namespace fulcrum
