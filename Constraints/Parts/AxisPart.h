// One row that limits the motion of two anchor points along an axis: contacts, friction, sliders, distances. A row part
// (RowPart.h) with this Jacobian.
//
// Source: D. Chappuis, "Constraints Derivation for Rigid Body Simulation in 3D" (contact and slider limits).
//   x1, x2  centers of mass             p1, p2  anchor points in world space
//   r1 = p1 - x1, r2 = p2 - x2          u = p2 - p1          n  unit axis, world space, moving with body 1
//   Constraint:  C = (p2 - p1) . n
//   Derivative:  dn/dt = w1 x n, so with u kept, dC/dt = (v2 + w2 x r2 - v1 - w1 x r1) . n + u . (w1 x n)
//                      = n . (v2 - v1) + (r2 x n) . w2 - ((r1 + u) x n) . w1
//   Jacobian:    J = [-n, -(r1 + u) x n, n, r2 x n]
//   K = J M^-1 J^T = 1/m1 + ((r1+u) x n) . I1^-1 ((r1+u) x n) + 1/m2 + (r2 x n) . I2^-1 (r2 x n)
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>

namespace fulcrum {

// World space: r1 + u (which is p2 - x1), r2 = p2 - x2, n of length 1.
template <class Real>
struct AxisFrame {
    Vec3<Real> r1PlusU;
    Vec3<Real> r2;
    Vec3<Real> axis;
};

template <class Real>
inline RowJacobian<Real> AxisJacobian(const AxisFrame<Real>& frame) {
    return {{frame.axis, Cross<Real>(frame.r1PlusU, frame.axis)}, {frame.axis, Cross<Real>(frame.r2, frame.axis)}};
}

}  // namespace fulcrum
