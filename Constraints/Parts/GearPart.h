// One row that couples the rotations of two bodies, each about its own axis: gears. A row part (RowPart.h) with this
// Jacobian.
//
// Own derivation.
//   a1, a2  unit axes in world space, each fixed in its body's bearing
//   theta1, theta2  rotation angles about them          ratio  revolutions of body 1 per revolution of body 2
//   Constraint:  C = theta1 + ratio theta2 - C0           (external gears turn against each other: ratio > 0)
//   Derivative:  dC/dt = w1 . a1 + ratio w2 . a2
//   Jacobian:    J = [0, a1, 0, ratio a2]
//   K = J M^-1 J^T = a1 . I1^-1 a1 + ratio^2 a2 . I2^-1 a2
// The caller supplies C, because it counts the revolutions. The bearings, which are other parts, take the reaction.
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>

namespace fulcrum {

template <class Real>
inline RowJacobian<Real> GearJacobian(const Vec3<Real>& axis1, const Vec3<Real>& axis2, const Real& ratio) {
    RowJacobian<Real> j;
    j.a.angular = -axis1;
    j.b.angular = axis2 * ratio;
    return j;
}

}  // namespace fulcrum
