// One row that limits the rotation of two bodies about an axis: twist friction, hinge limits and motors. A row part
// (RowPart.h) with this Jacobian.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (hinge limits).
//   theta  angle of body 2 relative to body 1 about a         a  unit axis, world space
//   Constraint:  C = theta - theta_min
//   Derivative:  dC/dt = a . (w2 - w1)
//   Jacobian:    J = [0, -a, 0, a]
//   K = J M^-1 J^T = a . I1^-1 a + a . I2^-1 a
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>

namespace fulcrum {

template <class Real>
inline RowJacobian<Real> AngleJacobian(const Vec3<Real>& axis) {
    RowJacobian<Real> j;
    j.a.angular = j.b.angular = axis;
    return j;
}

}  // namespace fulcrum
