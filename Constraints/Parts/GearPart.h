// One row that ties the rotation of two bodies about axes of their own: gears. Called by joints, which gather the
// bodies' lanes before and scatter them after. One thread per part.
//
// Own derivation.
//   a1, a2  unit axes in world space, each fixed in its body's bearing        ratio  turns of body 1 per turn of body 2
//   theta1, theta2  angles turned about them
//   Constraint:  C = theta1 + ratio theta2 - C0           (bodies that mesh outside turn against each other: ratio > 0)
//   Derivative:  dC/dt = w1 . a1 + ratio w2 . a2
//   Jacobian:    J = [0, a1, 0, ratio a2]
//   K = J M^-1 J^T = a1 . I1^-1 a1 + ratio^2 a2 . I2^-1 a2
// The caller supplies C: only it can count turns. The bearings, which are other parts, take the reaction.
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>

namespace fulcrum {

template <class Real>
class GearPart : public BlockPart<GearPart<Real>, Real, 1> {
public:
    using typename BlockPart<GearPart, Real, 1>::Vector;
    using typename BlockPart<GearPart, Real, 1>::Mask;

    // Once per substep. bias: b, rad/s. The solve reaches J v = -b.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vector& axis1,
                             const Vector& axis2, Real ratio, Real bias, const RowSoftness<Real>& softness = {}) {
        axis1_ = axis1;
        scaledAxis2_ = axis2 * ratio;
        Real k1(0.0f), k2(0.0f);
        if constexpr (HasMass(kSide1)) k1 = Between(axis1_, mass1.inertia, axis1_);
        if constexpr (HasMass(kSide2)) k2 = Between(scaledAxis2_, mass2.inertia, scaledAxis2_);
        this->SetRows(k1 + k2, bias, softness);
    }

    // J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        Real of1(0.0f), of2(0.0f);
        if constexpr (HasVelocity(kSide1)) of1 = Dot<Real>(axis1_, motion1.angular);
        if constexpr (HasVelocity(kSide2)) of2 = Dot<Real>(scaledAxis2_, motion2.angular);
        return of1 + of2;
    }

    // Adds M^-1 J^T lambda, where `applied`.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, Real lambda, Mask applied) const {
        if constexpr (HasMass(kSide1)) {
            const Vector angular = (mass1.inertia * axis1_) * -lambda;
            motion1.angular -= ZeroUnless<Real>(applied, angular);
        }
        if constexpr (HasMass(kSide2)) {
            const Vector angular = (mass2.inertia * scaledAxis2_) * -lambda;
            motion2.angular -= ZeroUnless<Real>(applied, angular);
        }
    }

private:
    Vector axis1_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    Vector scaledAxis2_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
};

}  // namespace fulcrum
