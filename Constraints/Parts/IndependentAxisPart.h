// One row that acts on two bodies along different axes: pulleys. A row part (RowPart.h) with this Jacobian.
//
// Own derivation.
//   p1, p2  points of the bodies where the rope is attached     f1, f2  fixed points over which it runs
//   n1 = (p1 - f1) / |p1 - f1|, n2 likewise, world space        r1 = p1 - x1, r2 = p2 - x2 from the centers of mass
//   ratio   of the block and tackle at body 2                   L  length of the rope
//   Constraint:  C = |p1 - f1| + ratio |p2 - f2| - L
//   Derivative:  dC/dt = n1 . (v1 + w1 x r1) + ratio n2 . (v2 + w2 x r2)
//   Jacobian:    J = [n1, r1 x n1, ratio n2, ratio r2 x n2]
//   K = J M^-1 J^T = 1/m1 + (r1 x n1) . I1^-1 (r1 x n1) + ratio^2 (1/m2 + (r2 x n2) . I2^-1 (r2 x n2))
// A rope can only pull: limit the total impulse to 0 or below. The caller supplies C.
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>

namespace fulcrum {

// World space; scaledAxis2 is axis 2 times the ratio.
template <class Real>
struct IndependentAxisFrame {
    Vec3<Real> r1;
    Vec3<Real> r2;
    Vec3<Real> axis1;
    Vec3<Real> scaledAxis2;
};

template <class Real>
inline RowJacobian<Real> IndependentAxisJacobian(const IndependentAxisFrame<Real>& frame) {
    return {{-frame.axis1, -Cross<Real>(frame.r1, frame.axis1)},
            {frame.scaledAxis2, Cross<Real>(frame.r2, frame.scaledAxis2)}};
}

}  // namespace fulcrum
