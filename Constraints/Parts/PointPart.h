// Three rows that hold two anchor points together: ball joints, and the translation of fixed and hinge joints. Called
// by joints, which gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (ball-and-socket joint).
//   x1, x2  centers of mass             p1, p2  anchor points in world space
//   r1 = p1 - x1, r2 = p2 - x2          [r]x  the matrix with [r]x v = r x v
//   Constraint:  C = p2 - p1 = x2 + r2 - x1 - r1
//   Derivative:  dC/dt = v2 + w2 x r2 - v1 - w1 x r1
//   Jacobian:    J = [-1, [r1]x, 1, -[r2]x]
//   K = J M^-1 J^T = (1/m1 + 1/m2) 1 + [r1]x I1^-1 [r1]x^T + [r2]x I2^-1 [r2]x^T
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>

namespace fulcrum {

template <class Real>
class PointPart : public BlockPart<PointPart<Real>, Real, 3> {
public:
    using typename BlockPart<PointPart, Real, 3>::Vector;
    using typename BlockPart<PointPart, Real, 3>::Mask;

    // Once per substep. r1, r2: world space, m.
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vector& r1,
                             const Vector& r2) {
        r1_ = r1;
        r2_ = r2;
        this->SetInverseEffectiveMass(PointInverseMass(mass1, mass2, r1, r2));
    }

    // J applied to velocities (m/s), or to displacements: the change of C to first order (m).
    Vector RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        return PointMotion(motion1, motion2, r1_, r2_);
    }

    // Adds M^-1 J^T lambda, where `applied`.
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, const Vector& lambda, Mask applied) const {
        AddPointImpulse(motion1, motion2, mass1, mass2, r1_, r2_, lambda, applied);
    }

    // World space, m, as set up.
    const Vector& GetArm1() const { return r1_; }
    const Vector& GetArm2() const { return r2_; }

private:
    Vector r1_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    Vector r2_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
};

}  // namespace fulcrum
