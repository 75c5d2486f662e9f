// The position error of a joint, as reports and JointInterface::GetError give it. Plain data.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

namespace fulcrum {

// The largest position error of a joint. Locks and rows that hold something have one: that of a lock is the gap or the
// angle that it should close; of a length out of its range, a limit that is exceeded, gears and racks out of phase, and
// a motor without softness that is not at its position, the excess. Springs, soft limits, motors to a speed, friction,
// and motors at their force limit have none.
struct JointError {
    float distance = 0;  // m, >= 0; of anchors along locked directions, and of rows in m
    float angle = 0;     // rad, >= 0; about locked axes, and of rows in rad
};

}  // namespace fulcrum
