// Two rows that lock the relative rotation of two bodies except about one axis: hinges, wheels. Called by joints, which
// gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (hinge joint);
// the error measure for large angles is our own.
//   a1      hinge axis, moving with body 1        b2, c2  axes that move with body 2; a2 = b2 x c2 is its hinge axis
//   theta   angle between a1 and a2, 0..pi
//   Constraint:  C = (a1 . b2, a1 . c2) theta / sin(theta)
//   Jacobian:    d(a1 . b2)/dt = (w2 - w1) . (b2 x a1); where a1 = a2 that is -c2, and b2 for the other row, so
//                J = [0, c2, 0, -c2; 0, -b2, 0, b2]
//   K = J M^-1 J^T = T^T (I1^-1 + I2^-1) T with T = [-c2, b2]
// a1 x a2 theta / sin(theta), the rotation vector from a1 to a2, has C as its components along -c2 and b2 and none
// along a2: a rotation by -C about those axes aligns a2 by the shortest rotation, from any angle. The plain dot
// products would vanish where the axes are opposite, and their Jacobian where they are perpendicular. At 180 degrees
// all rotations are equally short; C then is (pi, 0).
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>
#include <Fulcrum/Math/Trigonometry.h>

namespace fulcrum {

// C, rad. Unit vectors, b2 perpendicular to c2.
template <class Real>
inline Vec2<Real> HingeError(const Vec3<Real>& axis1, const Vec3<Real>& b2, const Vec3<Real>& c2) {
    const Real b = Dot<Real>(axis1, b2), c = Dot<Real>(axis1, c2);
    const Real sine = Sqrt(b * b + c * c);
    const Real cosine = Dot<Real>(axis1, Cross<Real>(b2, c2));
    const Real zero(0.0f), one(1.0f);
    // Below that the squares underflow; either theta / sin(theta) is 1, or any direction is correct.
    const MaskOf<Real> isStraight = sine < Real(1e-15f);
    const MaskOf<Real> isOpposite = isStraight & (cosine < zero);
    const Real scale = Select(isStraight, one, Atan2(sine, cosine) / Select(isStraight, one, sine));
    return Vec2<Real>(Select(isOpposite, Real(3.14159265f), b * scale), Select(isOpposite, zero, c * scale));
}

template <class Real>
class HingeRotationPart : public BlockPart<HingeRotationPart<Real>, Real, 2> {
public:
    using typename BlockPart<HingeRotationPart, Real, 2>::Vector;
    using typename BlockPart<HingeRotationPart, Real, 2>::Rows;
    using typename BlockPart<HingeRotationPart, Real, 2>::Mask;

    // Once per substep. b2, c2: world space, unit, perpendicular.
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Vector& b2,
                             const Vector& c2) {
        b2_ = b2;
        c2_ = c2;
        const Sym3<Real> angular = AngularInverseMass(mass1, mass2);
        Sym2<Real> k;
        k.xx = Between(c2, angular, c2);
        k.yy = Between(b2, angular, b2);
        k.xy = -Between(c2, angular, b2);
        this->SetInverseEffectiveMass(k);
    }

    // J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    Rows RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        const Vector motion = AngularMotion(motion1, motion2);
        return Rows(-Dot<Real>(c2_, motion), Dot<Real>(b2_, motion));
    }

    // Adds M^-1 J^T lambda, where `applied`.
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, const Rows& lambda, Mask applied) const {
        const Vector impulse = b2_ * lambda.y() - c2_ * lambda.x();
        AddAngularImpulse(motion1, motion2, mass1, mass2, impulse, applied);
    }

    // World space, as set up.
    const Vector& GetB2() const { return b2_; }
    const Vector& GetC2() const { return c2_; }

private:
    Vector b2_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
    Vector c2_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
};

}  // namespace fulcrum
