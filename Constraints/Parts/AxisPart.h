// One row that limits the motion of two anchor points along an axis: contacts, friction, sliders, distances. Called by
// contacts and joints, which gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (contact and slider limits).
//   x1, x2  centers of mass             p1, p2  anchor points in world space
//   r1 = p1 - x1, r2 = p2 - x2          u = p2 - p1          n  unit axis, world space, moving with body 1
//   Constraint:  C = (p2 - p1) . n
//   Derivative:  dn/dt = w1 x n, so with u kept, dC/dt = (v2 + w2 x r2 - v1 - w1 x r1) . n + u . (w1 x n)
//                      = n . (v2 - v1) + (r2 x n) . w2 - ((r1 + u) x n) . w1
//   Jacobian:    J = [-n, -(r1 + u) x n, n, r2 x n]
//   K = J M^-1 J^T = 1/m1 + ((r1+u) x n) . I1^-1 ((r1+u) x n) + 1/m2 + (r2 x n) . I2^-1 (r2 x n)
//   A solve changes the impulse by delta lambda = -K^-1 (J v + b) (soft: SpringPart.h), clamps the total to its limits
//   and adds M^-1 J^T delta lambda to the velocities.
//
// What a part keeps is small, because large scenes are limited by memory: the axis and the masses, which other rows of
// the same constraint share, are handed in again at every call and must be those of the set-up (another mass may be
// forced with OverrideMass); I^-1 (r x n) is recomputed from them, which saves six numbers a row.
#pragma once

#include <Fulcrum/Constraints/Parts/SpringPart.h>

namespace fulcrum {

// World space: r1 + u (which is p2 - x1), r2 = p2 - x2, n of length 1.
template <class Real>
struct AxisFrame {
    Vec3<Real> r1PlusU;
    Vec3<Real> r2;
    Vec3<Real> axis;
};

// Real: float, or Wide<N> for N constraints; both give the same bits. kSoft false: a row that is never a spring.
// The sides are compile-time: BodySide says what a static or kinematic one saves. Twists and masses of sides that are
// not read may be anything.
template <class Real, bool kSoft = true>
class AxisPart {
public:
    using Mask = MaskOf<Real>;
    using Vector = Vec3<Real>;
    using State = RowState<Real>;

    // Set-up, once per substep. Leaves the total impulse for the warm start, but zero where the row is inactive.
    // bias: b, m/s. The solve reaches J v = -b.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                             const AxisFrame<Real>& frame, Real bias) {
        spring_.SetHard(SetJacobian<kSide1, kSide2>(mass1, mass2, frame), bias);
        ForgetInactive();
    }
    // Soft. dt > 0, s; error: C, m; the constants come from ToConstants of valid SpringSettings. Hard where those are
    // zero.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateSpringProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                   const AxisFrame<Real>& frame, Real bias, Real error,
                                   const SpringConstants<Real>& spring) requires kSoft {
        spring_.SetSoft(dt, SetJacobian<kSide1, kSide2>(mass1, mass2, frame), bias, error, spring);
        ForgetInactive();
    }
    // The same for one constraint, from its settings, from a frequency (Hz) and damping ratio, or from a stiffness
    // (N/m) and damping (N s/m), all >= 0.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateSpringProperties(float dt, const InverseMass<float>& mass1, const InverseMass<float>& mass2,
                                   const AxisFrame<float>& frame, float bias, float error,
                                   const SpringSettings& settings) requires(kSoft&& std::is_same_v<Real, float>) {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, frame, bias, error, ToConstants(settings));
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateFrequencyProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                      const AxisFrame<Real>& frame, Real bias, Real error, Real frequency,
                                      Real dampingRatio) requires kSoft {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, frame, bias, error,
                                                  FrequencyConstants(frequency, dampingRatio));
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateStiffnessProperties(Real dt, const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                                      const AxisFrame<Real>& frame, Real bias, Real error, Real stiffness,
                                      Real damping) requires kSoft {
        CalculateSpringProperties<kSide1, kSide2>(dt, mass1, mass2, frame, bias, error,
                                                  StiffnessConstants(stiffness, damping));
    }

    // Another bias (m/s) for a hard row that is otherwise as it was set up.
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

    // One iteration; the total impulse stays in [minLambda, maxLambda], N s. Returns where anything was applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Vector& axis, Real minLambda, Real maxLambda) {
        const Real candidate = SolveTotalLambda<kSide1, kSide2>(velocity1, velocity2, axis);
        return ApplyTotalLambda<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, axis,
                                                Clamp(candidate, minLambda, maxLambda));
    }
    // The two halves of it. First the total impulse that would satisfy the row, which changes nothing; then, clamped by
    // the caller (to friction's cone, with the other row's), it is applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real SolveTotalLambda(const Twist<Real>& velocity1, const Twist<Real>& velocity2, const Vector& axis) const {
        return spring_.SolveTotalLambda(RelativeMotion<kSide1, kSide2>(velocity1, velocity2, axis), totalLambda_);
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask ApplyTotalLambda(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                          const InverseMass<Real>& mass2, const Vector& axis, Real totalLambda) {
        const Real deltaLambda = Select(IsActive(), totalLambda - totalLambda_, Real(0.0f));
        const Mask applied = ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, axis, deltaLambda);
        totalLambda_ = Select(applied, totalLambda, totalLambda_);
        return applied;
    }

    // One position pass: moves the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J.
    // error: C as the poses are now, m; zero where it is satisfied. Springs are left alone: their error is their force.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Vector& axis, Real error, Real baumgarte) const {
        const Real lambda = -(spring_.GetEffectiveMass() * baumgarte * error);
        return ApplyImpulse<kSide1, kSide2>(displacement1, displacement2, mass1, mass2, axis,
                                            Select(spring_.IsHard(), lambda, Real(0.0f)));
    }

    // J applied to velocities (m/s), or to displacements: the change of C to first order (m).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2, const Vector& axis) const {
        if constexpr (HasVelocity(kSide1) && HasVelocity(kSide2)) {
            const Vector linear = motion2.linear - motion1.linear;
            return Dot<Real>(axis, linear) + Dot<Real>(r2CrossAxis_, motion2.angular) -
                   Dot<Real>(r1PlusUCrossAxis_, motion1.angular);
        } else if constexpr (HasVelocity(kSide2)) {
            return Dot<Real>(axis, motion2.linear) + Dot<Real>(r2CrossAxis_, motion2.angular);
        } else if constexpr (HasVelocity(kSide1)) {
            return -Dot<Real>(axis, motion1.linear) - Dot<Real>(r1PlusUCrossAxis_, motion1.angular);
        } else {
            return Real(0.0f);
        }
    }

    // N s.
    Real GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(Real totalLambda) { totalLambda_ = totalLambda; }
    // Softened for a spring; zero where inactive. kg.
    Real GetEffectiveMass() const { return spring_.GetEffectiveMass(); }

    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

private:
    // Returns K.
    template <BodySide kSide1, BodySide kSide2>
    Real SetJacobian(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const AxisFrame<Real>& frame) {
        if constexpr (HasVelocity(kSide1)) r1PlusUCrossAxis_ = Cross<Real>(frame.r1PlusU, frame.axis);
        if constexpr (HasVelocity(kSide2)) r2CrossAxis_ = Cross<Real>(frame.r2, frame.axis);
        Real sum1(0.0f), sum2(0.0f);
        if constexpr (HasMass(kSide1))
            sum1 = mass1.mass + Dot<Real>(r1PlusUCrossAxis_, mass1.inertia * r1PlusUCrossAxis_);
        if constexpr (HasMass(kSide2)) sum2 = mass2.mass + Dot<Real>(r2CrossAxis_, mass2.inertia * r2CrossAxis_);
        return sum1 + sum2;
    }

    // Adds M^-1 J^T lambda where lambda is not zero; NaN counts as zero, so that one bad constraint spoils no body.
    template <BodySide kSide1, BodySide kSide2>
    Mask ApplyImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                      const InverseMass<Real>& mass2, const Vector& axis, Real lambda) const {
        const Mask applied = (lambda < Real(0.0f)) | (lambda > Real(0.0f));
        if constexpr (HasMass(kSide1)) {
            const Vector linear = axis * (mass1.mass * lambda);
            const Vector angular = (mass1.inertia * r1PlusUCrossAxis_) * lambda;
            motion1.linear -= ZeroUnless<Real>(applied, linear);
            motion1.angular -= ZeroUnless<Real>(applied, angular);
        }
        if constexpr (HasMass(kSide2)) {
            const Vector linear = axis * (mass2.mass * -lambda);
            const Vector angular = (mass2.inertia * r2CrossAxis_) * -lambda;
            motion2.linear -= ZeroUnless<Real>(applied, linear);
            motion2.angular -= ZeroUnless<Real>(applied, angular);
        }
        return applied;
    }

    void ForgetInactive() { totalLambda_ = Select(IsActive(), totalLambda_, Real(0.0f)); }

    Vector r1PlusUCrossAxis_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    Vector r2CrossAxis_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    SpringPart<Real, kSoft> spring_;
    Real totalLambda_ = Real(0.0f);
};

}  // namespace fulcrum
