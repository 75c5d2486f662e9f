// Two rows that lock the motion of an anchor point along two axes, so that it can only slide along the third: sliders,
// points on lines. Called by joints, which gather the bodies' lanes before and scatter them after. One thread per part.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (slider joint).
//   x1, x2  centers of mass             p1, p2  anchor points in world space        r1 = p1 - x1, r2 = p2 - x2
//   u = p2 - p1                         n1, n2  orthonormal axes in world space, moving with body 1
//   Constraint:  C = (u . n1, u . n2)
//   Derivative:  with u kept (see AxisPart.h), dC_i/dt = n_i . (v2 + w2 x r2 - v1 - w1 x (r1 + u))
//   Jacobian:    row i = [-n_i, -(r1 + u) x n_i, n_i, r2 x n_i]
//   K = J M^-1 J^T = N^T K_p N with N = [n1 n2] and K_p that of the point part at r1 + u and r2: both impulses act at
//   p2.
#pragma once

#include <Fulcrum/Constraints/Parts/BlockPart.h>

namespace fulcrum {

// World space: r1 + u (which is p2 - x1), r2 = p2 - x2, n1 and n2 of length 1 and perpendicular.
template <class Real>
struct DualAxisFrame {
    Vec3<Real> r1PlusU;
    Vec3<Real> r2;
    Vec3<Real> axis1;
    Vec3<Real> axis2;
};

template <class Real>
class DualAxisPart : public BlockPart<DualAxisPart<Real>, Real, 2> {
public:
    using typename BlockPart<DualAxisPart, Real, 2>::Vector;
    using typename BlockPart<DualAxisPart, Real, 2>::Rows;
    using typename BlockPart<DualAxisPart, Real, 2>::Mask;

    // Once per substep.
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2,
                             const DualAxisFrame<Real>& frame) {
        frame_ = frame;
        const Sym3<Real> point = PointInverseMass(mass1, mass2, frame.r1PlusU, frame.r2);
        Sym2<Real> k;
        k.xx = Between(frame.axis1, point, frame.axis1);
        k.yy = Between(frame.axis2, point, frame.axis2);
        k.xy = Between(frame.axis1, point, frame.axis2);
        this->SetInverseEffectiveMass(k);
    }

    // J applied to velocities (m/s), or to displacements: the change of C to first order (m).
    Rows RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2) const {
        const Vector motion = PointMotion(motion1, motion2, frame_.r1PlusU, frame_.r2);
        return Rows(Dot<Real>(frame_.axis1, motion), Dot<Real>(frame_.axis2, motion));
    }

    // Adds M^-1 J^T lambda, where `applied`.
    void AddImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                    const InverseMass<Real>& mass2, const Rows& lambda, Mask applied) const {
        const Vector impulse = frame_.axis1 * lambda.x() + frame_.axis2 * lambda.y();
        AddPointImpulse(motion1, motion2, mass1, mass2, frame_.r1PlusU, frame_.r2, impulse, applied);
    }

    // As set up.
    const DualAxisFrame<Real>& GetFrame() const { return frame_; }

private:
    static Vector Zero() { return Vector(Real(0.0f), Real(0.0f), Real(0.0f)); }
    DualAxisFrame<Real> frame_ = {Zero(), Zero(), Zero(), Zero()};
};

}  // namespace fulcrum
