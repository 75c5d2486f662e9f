// One constraint row between two bodies, given by its Jacobian. Axis, angle, gear, rack-and-pinion and independent-axis
// parts are row parts, each with its own Jacobian, and so is every row of a joint. One thread per part.
//
//   J  Jacobian        M^-1 J^T  response (RowJacobian.h)        lambda  total impulse, N s or N m s
//   K = J M^-1 J^T, the inverse of the effective mass
//   A solve changes lambda by -K^-1 (J v + b) (soft: RowSoftness.h), clamps the total to its limits and adds the
//   response times the change to the velocities.
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D".
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>

namespace fulcrum {

// The state of a row that is kept from step to step: saved to the joint and restored from it.
template <class Real>
struct RowState {
    Real totalLambda = Real(0.0f);
};

// Real: float, or Wide<N> for N constraints; both give the same bits. kSide1, kSide2 are compile-time: see BodySide for
// what static and kinematic sides skip; arguments that are skipped may have any value.
template <class Real>
class RowPart {
public:
    using Mask = MaskOf<Real>;
    using State = RowState<Real>;

    // Set-up, once per substep: Jacobian, response and effective mass, then SetBias. Keeps the total impulse for the
    // warm start, but sets it to zero if the row is inactive.
    FULCRUM_FORCE_INLINE void SetJacobian(const RowJacobian<Real>& jacobian) { jacobian_ = jacobian; }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    FULCRUM_FORCE_INLINE void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2) {
        response_ = ResponseOf<kSide1, kSide2>(jacobian_, mass1, mass2);
        inverseEffectiveMass_ = RelativeMotion(jacobian_, response_.a, response_.b);
        SetEffectiveMass(inverseEffectiveMass_, Real(0.0f));
    }
    // Called after CalculateProperties if locks between the two bodies react to the row's impulse: `response` is the
    // change of velocity by a unit of impulse together with their reaction. A row that is fully determined by the locks
    // becomes inactive.
    FULCRUM_FORCE_INLINE void SetResponse(const RowResponse<Real>& response) {
        response_ = response;
        SetEffectiveMass(RelativeMotion(jacobian_, response_.a, response_.b), inverseEffectiveMass_ * Real(1e-5f));
    }
    // scaledBias: massScale (b + beta C), m/s or rad/s; a hard row reaches J v = -b. softness: of error correction
    // (PushSoftnessOf) or of a spring (SpringSoftnessOf).
    FULCRUM_FORCE_INLINE void SetBias(const Real& scaledBias, const RowSoftness<Real>& softness = {}) {
        softMass_ = effectiveMass_ * softness.massScale;
        biasImpulse_ = effectiveMass_ * scaledBias;
        impulseScale_ = softness.impulseScale;
    }

    // In these lanes, whose rows are hard, only the bias.
    FULCRUM_FORCE_INLINE void SetHardBias(const Real& bias, const Mask& mask) {
        biasImpulse_ = Select(mask, effectiveMass_ * bias, biasImpulse_);
    }
    // lambda (b + motion) and gamma lambda^2, in W or J per second: see WarmStart.h. motion: of bodies that are not
    // dynamic, along J.
    FULCRUM_FORCE_INLINE Vec2<Real> WarmStartWork(const Real& lambda, const Real& motion) const {
        const Mask acts = softMass_ > Real(0.0f);
        const Real perMass = lambda / Select(acts, softMass_, Real(1.0f));
        return Vec2<Real>(Select(acts, perMass * biasImpulse_ + lambda * motion, Real(0.0f)),
                          Select(acts, perMass * lambda * impulseScale_, Real(0.0f)));
    }

    // What iterations converge to: impulseScale lambda = -(softMass J v + biasImpulse), within the limits.
    struct Target {
        const Real &softMass, &biasImpulse, &impulseScale;
    };
    Target TargetOf() const { return {softMass_, biasImpulse_, impulseScale_}; }

    void Deactivate(const Mask& mask) {
        for (Real* x : {&effectiveMass_, &softMass_, &biasImpulse_, &totalLambda_}) *x = Select(mask, Real(0.0f), *x);
    }
    Mask IsActive() const { return effectiveMass_ > Real(0.0f); }

    // Applies the total impulse.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    FULCRUM_FORCE_INLINE void WarmStart(Twist<Real>& velocity1, Twist<Real>& velocity2) const {
        AddResponse<kSide1, kSide2>(response_, totalLambda_, velocity1, velocity2);
    }

    // One iteration; the total impulse stays in [minLambda, maxLambda], N s or N m s. Returns the mask of lanes in
    // which an impulse was applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    FULCRUM_FORCE_INLINE Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const Real& minLambda,
                                            const Real& maxLambda) {
        return ApplyTotalLambda<kSide1, kSide2>(
            velocity1, velocity2, Clamp(SolveTotalLambda<kSide1, kSide2>(velocity1, velocity2), minLambda, maxLambda));
    }
    // The two halves of SolveVelocity. The first returns the total impulse that would satisfy the row, and changes
    // nothing. The second applies a total impulse that the caller has clamped (to a friction cone, together with
    // another row's).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    FULCRUM_FORCE_INLINE Real SolveTotalLambda(const Twist<Real>& velocity1, const Twist<Real>& velocity2) const {
        const Real impulse = softMass_ * RelativeMotion<kSide1, kSide2>(jacobian_, velocity1, velocity2) + biasImpulse_;
        return totalLambda_ + SoftDelta<Real, Real>(impulse, totalLambda_, impulseScale_);
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    FULCRUM_FORCE_INLINE Mask ApplyTotalLambda(Twist<Real>& velocity1, Twist<Real>& velocity2,
                                               const Real& totalLambda) {
        const Real deltaLambda = Select(IsActive(), totalLambda - totalLambda_, Real(0.0f));
        const Mask applied = AddResponse<kSide1, kSide2>(response_, deltaLambda, velocity1, velocity2);
        totalLambda_ = Select(applied, totalLambda, totalLambda_);
        return applied;
    }

    // One position pass: moves the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J.
    // error: C at the current poses, m or rad; zero if satisfied, and zero for springs, whose error is their force.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const Real& error,
                       const Real& baumgarte) const {
        return AddResponse<kSide1, kSide2>(response_, Real(effectiveMass_ * baumgarte * -error), displacement1,
                                           displacement2);
    }

    const RowJacobian<Real>& GetJacobian() const { return jacobian_; }
    const RowResponse<Real>& GetResponse() const { return response_; }
    // 1 / K without the softness; zero if inactive. kg or kg m2.
    const Real& GetEffectiveMass() const { return effectiveMass_; }

    // N s or N m s.
    const Real& GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(const Real& totalLambda) { totalLambda_ = totalLambda; }
    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

private:
    // Inactive if K is `least` or below: no body can move.
    FULCRUM_FORCE_INLINE void SetEffectiveMass(const Real& k, const Real& least) {
        const Mask movable = k > least;
        effectiveMass_ = Select(movable, Real(1.0f) / Select(movable, k, Real(1.0f)), Real(0.0f));
        totalLambda_ = Select(movable, totalLambda_, Real(0.0f));
    }

    RowJacobian<Real> jacobian_;
    RowResponse<Real> response_;
    Real inverseEffectiveMass_ = Real(0.0f);  // K without the locks
    Real effectiveMass_ = Real(0.0f);
    // Premultiplied by the effective mass, which saves a product per solve.
    Real softMass_ = Real(0.0f), biasImpulse_ = Real(0.0f);
    Real impulseScale_ = Real(0.0f);
    Real totalLambda_ = Real(0.0f);
};

}  // namespace fulcrum
