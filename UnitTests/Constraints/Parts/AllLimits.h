// The limits of a rotation, of swing and twist together, as the tests of the limits look at them.
#pragma once

#include <Fulcrum/Constraints/Parts/SwingTwist.h>

namespace fulcrum::testing {

inline RotationLimitList CollectLimits(const Quaternion& q, const SwingTwistLimits& limits) {
    RotationLimitList list;
    const SwingTwist r = Decompose(q);
    AddSwingLimits(list, r, limits);
    AddTwistLimits(list, r, limits.twist);
    return list;
}

}  // namespace fulcrum::testing
