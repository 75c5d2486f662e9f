// One row on two bodies along different axes: pulleys. Called by joints, which gather the bodies' lanes before and
// scatter them after. One thread per part.
//
// Own derivation.
//   p1, p2  points of the bodies where the rope is tied         f1, f2  fixed points over which it runs
//   n1 = (p1 - f1) / |p1 - f1|, n2 likewise, world space        r1 = p1 - x1, r2 = p2 - x2 from the centers of mass
//   ratio   of the block and tackle at body 2                   L  length of the rope
//   Constraint:  C = |p1 - f1| + ratio |p2 - f2| - L
//   Derivative:  dC/dt = n1 . (v1 + w1 x r1) + ratio n2 . (v2 + w2 x r2)
//   Jacobian:    J = [n1, r1 x n1, ratio n2, ratio r2 x n2]
//   K = J M^-1 J^T = 1/m1 + (r1 x n1) . I1^-1 (r1 x n1) + ratio^2 (1/m2 + (r2 x n2) . I2^-1 (r2 x n2))
// A rope can only pull: keep the total impulse at 0 or below. The caller supplies C.
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>

namespace fulcrum {

// World space; n1 and n2 of length 1.
template <class Real>
struct IndependentAxisFrame {
    Vec3<Real> r1;
    Vec3<Real> r2;
    Vec3<Real> axis1;
    Vec3<Real> axis2;
    Real ratio;
};

template <class Real>
class IndependentAxisPart : public BlockPart<IndependentAxisPart<Real>, Real, 1> {
public:
    using typename BlockPart<IndependentAxisPart, Real, 1>::Vector;
    using typename BlockPart<IndependentAxisPart, Real, 1>::Mask;

    // Once per substep. bias: b, m/s. The solve reaches J v = -b.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                             const IndependentAxisFrame<Real>& frame, Real bias,
                             const RowSoftness<Real>& softness = {}) {
        axis1_ = frame.axis1;
        scaledAxis2_ = frame.axis2 * frame.ratio;
        r1CrossAxis1_ = Cross<Real>(frame.r1, axis1_);
        r2CrossScaledAxis2_ = Cross<Real>(frame.r2, scaledAxis2_);
        Real k1(0.0f), k2(0.0f);
        if constexpr (HasMass(kSide1)) k1 = mass1.mass + Between(r1CrossAxis1_, mass1.inertia, r1CrossAxis1_);
        if constexpr (HasMass(kSide2))
            k2 = frame.ratio * frame.ratio * mass2.mass +
                 Between(r2CrossScaledAxis2_, mass2.inertia, r2CrossScaledAxis2_);
        this->SetRows(k1 + k2, bias, softness);
    }

    // J applied to velocities (m/s), or to displacements: the change of C to first order (m).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        Real of1(0.0f), of2(0.0f);
        if constexpr (HasVelocity(kSide1))
            of1 = Dot<Real>(axis1_, motion1.linear) + Dot<Real>(r1CrossAxis1_, motion1.angular);
        if constexpr (HasVelocity(kSide2))
            of2 = Dot<Real>(scaledAxis2_, motion2.linear) + Dot<Real>(r2CrossScaledAxis2_, motion2.angular);
        return of1 + of2;
    }

    // Adds M^-1 J^T lambda, where `applied`.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, Real lambda, Mask applied) const {
        if constexpr (HasMass(kSide1)) Push(motion1, mass1, axis1_, r1CrossAxis1_, lambda, applied);
        if constexpr (HasMass(kSide2)) Push(motion2, mass2, scaledAxis2_, r2CrossScaledAxis2_, lambda, applied);
    }

private:
    static void Push(Twist<Real>& motion, const InverseMass<Real>& mass, const Vector& axis, const Vector& arm,
                     Real lambda, Mask applied) {
        const Vector linear = axis * (mass.mass * -lambda);
        const Vector angular = (mass.inertia * arm) * -lambda;
        motion.linear -= ZeroUnless<Real>(applied, linear);
        motion.angular -= ZeroUnless<Real>(applied, angular);
    }
    static Vector Zero() { return Vector(Real(0.0f), Real(0.0f), Real(0.0f)); }

    Vector axis1_ = Zero(), scaledAxis2_ = Zero();
    Vector r1CrossAxis1_ = Zero(), r2CrossScaledAxis2_ = Zero();
};

}  // namespace fulcrum
