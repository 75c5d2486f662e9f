// One row that ties the rotation of body 1, the pinion, to the translation of body 2, the rack: rack and pinion,
// screws, winches. Called by joints, which gather the bodies' lanes before and scatter them after. One thread per part.
//
// Own derivation.
//   a  unit axis of the pinion, n  unit direction of the rack, world space      ratio  rad that the pinion turns per
//   meter theta  angle turned by the pinion about a                                   d  way of the rack's center along
//   n Constraint:  C = theta - ratio d - C0 Derivative:  dC/dt = w1 . a - ratio v2 . n Jacobian:    J = [0, a, -ratio
//   n, 0] K = J M^-1 J^T = a . I1^-1 a + ratio^2 / m2
// The caller supplies C: only it can count turns. Guide and bearing, which are other parts, take the reaction.
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>

namespace fulcrum {

template <class Real>
class RackAndPinionPart : public BlockPart<RackAndPinionPart<Real>, Real, 1> {
public:
    using typename BlockPart<RackAndPinionPart, Real, 1>::Vector;
    using typename BlockPart<RackAndPinionPart, Real, 1>::Mask;

    // Once per substep. bias: b, rad/s. The solve reaches J v = -b.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vector& pinionAxis,
                             const Vector& rackAxis, Real ratio, Real bias, const RowSoftness<Real>& softness = {}) {
        pinionAxis_ = pinionAxis;
        scaledRackAxis_ = rackAxis * ratio;
        Real k1(0.0f), k2(0.0f);
        if constexpr (HasMass(kSide1)) k1 = Between(pinionAxis_, mass1.inertia, pinionAxis_);
        if constexpr (HasMass(kSide2)) k2 = ratio * ratio * mass2.mass;
        this->SetRows(k1 + k2, bias, softness);
    }

    // J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        Real of1(0.0f), of2(0.0f);
        if constexpr (HasVelocity(kSide1)) of1 = Dot<Real>(pinionAxis_, motion1.angular);
        if constexpr (HasVelocity(kSide2)) of2 = Dot<Real>(scaledRackAxis_, motion2.linear);
        return of1 - of2;
    }

    // Adds M^-1 J^T lambda, where `applied`.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, Real lambda, Mask applied) const {
        if constexpr (HasMass(kSide1)) {
            const Vector angular = (mass1.inertia * pinionAxis_) * -lambda;
            motion1.angular -= ZeroUnless<Real>(applied, angular);
        }
        if constexpr (HasMass(kSide2)) {
            const Vector linear = scaledRackAxis_ * (mass2.mass * lambda);
            motion2.linear -= ZeroUnless<Real>(applied, linear);
        }
    }

private:
    Vector pinionAxis_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    Vector scaledRackAxis_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
};

}  // namespace fulcrum
