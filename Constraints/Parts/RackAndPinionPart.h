// One row that couples the rotation of body 1, the pinion, to the relative translation of body 2, the rack: rack and
// pinion, screws, winches. A row part (RowPart.h) with this Jacobian.
//
// Own derivation.
//   a      unit axis of the pinion, n  unit direction of the rack, both in world space; n rotates with the rack
//   ratio  rotation of the pinion per meter, rad/m     theta  rotation angle of the pinion about a
//   r1, r2 from the centers of mass to the anchors     u = p2 - p1 between them
//   d      distance of the rack's anchor from the pinion's along n: u . n
//   Constraint:  C = theta - ratio (d - d0)
//   Derivative:  with dn/dt = w2 x n, dd/dt = n . (v2 - v1) + ((r2 - u) x n) . w2 - (r1 x n) . w1
//   Jacobian:    with s = -ratio n: J = [-s, a - r1 x s, s, (r2 - u) x s]
// The reaction acts at the pinion's anchor, which therefore should be on its axis: linear momentum is conserved. The
// caller supplies C, because it counts the revolutions.
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>

namespace fulcrum {

// World space, m; pinionAxis and rackAxis of length 1; ratio in rad/m.
template <class Real>
struct RackAndPinionFrame {
    Vec3<Real> r1;
    Vec3<Real> r2MinusU;
    Vec3<Real> pinionAxis;
    Vec3<Real> rackAxis;
    Real ratio;
};

template <class Real>
inline RowJacobian<Real> RackAndPinionJacobian(const RackAndPinionFrame<Real>& frame) {
    const Vec3<Real> scaled = frame.rackAxis * -frame.ratio;
    return {{scaled, Cross<Real>(frame.r1, scaled) - frame.pinionAxis}, {scaled, Cross<Real>(frame.r2MinusU, scaled)}};
}

}  // namespace fulcrum
