// Joints that are strained: impacts and contacts have moved their bodies apart faster than iterations of single joints
// could prevent; and joints past their limits: limits contradict each other or the load, and iterations that push them
// back and forth make energy. From then until they sleep, a mechanism whose joints all pass torque on, or one with a
// joint past its limits that nothing touches, is solved by the direct solver (Stages/HardMechanisms.h). Free functions
// over lanes, no state.
#pragma once

#include <Fulcrum/Constraints/Parts/BodySide.h>
#include <Fulcrum/Constraints/Parts/BodyState.h>

namespace fulcrum::joints {

// A joint is strained if the gap between its anchors exceeds this fraction of a body's lever arm and radius of
// gyration, or its locked angles exceed this in rad. It is past a limit by as many rad, or m.
inline constexpr float kStrain = 0.03f;

// Whether a gap is large for one of the bodies, with squared gap and arm in m2. The trace of the inverse inertia is
// three times the inverse mass over the squared radius of gyration. No gap is large for a body that cannot rotate.
template <class Real>
FULCRUM_FORCE_INLINE MaskOf<Real> IsStrainedBy(const Real& squaredGap, const Real& squaredArm, const Real& inverseMass,
                                               const Real& inverseInertiaTrace) {
    return squaredGap * inverseInertiaTrace >
           Real(kStrain * kStrain) * (squaredArm * inverseInertiaTrace + Real(3.0f) * inverseMass);
}

}  // namespace fulcrum::joints
