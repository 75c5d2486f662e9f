// Random limits, motors and friction of an axis, of which none acts while the axis stays where it is. One thread.
#pragma once

#include <Fulcrum/Constraints/Joints/AxisControl.h>
#include <Fulcrum/UnitTests/Random/Mechanism.h>

namespace fulcrum::testing {

// A spring of any frequency and damping, or one that is hard.
inline SpringSettings RandomSpring(RandomPoses& random, float hardChance) {
    if (random.Chance(hardChance)) return {};
    const float frequency = LogBetween(random, 0.5, 20);
    return {.frequency = frequency, .dampingRatio = random.Between(0, 1.5f)};
}

// Of an axis that is at zero: m or rad, N or N m. The limits are at least a fiftieth of `range` away, at most the
// whole.
inline AxisControl RandomControl(RandomPoses& random, float range, bool symmetric = false) {
    AxisControl control;
    if (random.Chance(0.25f)) {
        control.limited = true;
        control.limits.max = range * LogBetween(random, 0.02, 1);
        control.limits.min = symmetric ? -control.limits.max : -range * LogBetween(random, 0.02, 1);
        control.limits.spring = RandomSpring(random, 0.7f);
    }
    const float kind = random.Between(0, 1);
    if (kind < 0.4f) {
        control.motor.mode = kind < 0.25f ? MotorMode::ToVelocity : MotorMode::ToPosition;
        control.motor.spring = RandomSpring(random, 0.2f);
        if (random.Chance(0.3f)) {
            control.motor.maxForce = LogBetween(random, 1, 1000);
            control.motor.minForce = -control.motor.maxForce;
        }
    }
    if (random.Chance(0.15f)) control.friction = LogBetween(random, 0.01, 10);
    return control;
}

}  // namespace fulcrum::testing
