// Limits, motor and friction of one free axis of a joint. Set by the user when the joint is created, may be changed
// between steps; joint types turn it into rows in CollectRows. Plain data and free functions, no threads.
#pragma once

#include <Fulcrum/Constraints/Parts/SpringSettings.h>

#include <cstdint>
#include <limits>

namespace fulcrum {

struct JointPose;
struct JointRow;
struct JointRowList;

// Axes of a joint's frame: translation along them, rotation about them.
enum class JointAxis : uint8_t { LinearX, LinearY, LinearZ, AngularX, AngularY, AngularZ };

// m or rad.
struct JointLimits {
    float min = 0.0f;         // -infinity: none on this side
    float max = 0.0f;         // >= min; equal to min: locked there; infinity: none on this side
    SpringSettings spring{};  // frequency 0 or stiffness 0: a hard stop
};

enum class MotorMode : uint8_t {
    Off,
    ToVelocity,  // drives the axis at targetSpeed
    ToPosition,  // drives the axis to targetPosition by its spring
};

struct JointMotor {
    MotorMode mode = MotorMode::Off;
    float targetSpeed =
        0.0f;  // m/s or rad/s; reduced near a hard limit, so that the axis stops there without an impact
    float targetPosition = 0.0f;  // m or rad; clamped to the limits
    SpringSettings spring = {.frequency = 2.0f,
                             .dampingRatio = 1.0f};            // for ToPosition; hard: as fast as the forces allow
    float minForce = -std::numeric_limits<float>::infinity();  // N or N m, <= 0
    float maxForce = std::numeric_limits<float>::infinity();   // N or N m, >= 0
};

struct AxisControl {
    bool limited = false;
    JointLimits limits{};  // used where limited
    JointMotor motor{};
    float friction = 0.0f;  // N or N m, >= 0: the largest force against motion
};

// Valid ranges of an axis' limits, m or rad: lowest <= min <= highestMin, lowestMax <= max <= highest.
struct LimitBounds {
    static constexpr float kEndless = std::numeric_limits<float>::infinity();
    float lowest = -kEndless, highestMin = kEndless, lowestMax = -kEndless, highest = kEndless;
    bool symmetric = false;  // min = -max
};

// Whether these settings mean a hard constraint.
inline bool IsHard(const SpringSettings& spring) {
    return (spring.mode == SpringMode::StiffnessAndDamping ? spring.stiffness : spring.frequency) <= 0.0f;
}

// Whether a motor with a target speed drives the axis between hard stops. One with a target position has it within
// them.
inline bool IsDrivenAtStops(const AxisControl& control) {
    return control.motor.mode == MotorMode::ToVelocity && control.limited && control.limits.min < control.limits.max &&
           IsHard(control.limits.spring);
}

// Slots of the rows of one axis, relative to the axis' first slot.
struct ControlSlots {
    static constexpr uint32_t kLowLimit = 0, kHighLimit = 1, kMotor = 2, kFriction = 3, kCount = 4;
};

// The largest number of rows that AddControlRows adds.
uint32_t MaxControlRows(const AxisControl& control);

// The control while its limits do not apply. If they lock the axis there are no other rows, and none are left.
AxisControl WithoutLimits(const AxisControl& control);

// Margin added to the speed of an axis (current, or of its motor) when deciding which limits may be reached within the
// step, since other accelerations are not known then. Covers 120 m/s2 and 240 rad/s2 at 60 Hz; beyond that a limit acts
// one step late.
inline constexpr float kLinearSlackSpeed = 1.0f;   // m/s
inline constexpr float kAngularSlackSpeed = 2.0f;  // rad/s

// The largest displacement that the spring of a position motor can cause within dt, s, from rest at `distance`, m or
// rad, from its target: that of an undamped oscillator, distance (1 - cos(w dt)).
float SpringTravel(const SpringSettings& spring, float distance, float dt);

// Growth rate, m/s, average over the step, of the distance between two points due to relative motion perpendicular to
// the line between them at `speed`, m/s: (v dt)^2 / 2 d in the step, v dt at most.
float StretchSpeed(float distance, float speed, float dt);

// An axis beyond its limit by less than this, m or rad, counts as at the limit, so that rounding does not switch motors
// on and off.
inline constexpr float kLimitSlop = 1e-3f;

// Adds the row that keeps C >= 0, with C = `error` and J that of `motion` times sign.
JointRow& AddLimitRow(const SpringSettings& spring, const JointRow& motion, float sign, float error, uint32_t slot,
                      JointRowList& rows);
// Adds the row that keeps C = 0.
void AddLockRow(const SpringSettings& spring, const JointRow& motion, float error, uint32_t slot, JointRowList& rows);

// Adds the rows of an axis at `position` (m or rad) with rate J v, J that of `motion` (only its Jacobian is read): the
// limits that may be reached within the step, the motor if on, friction if any. Limits are added last, so they win over
// the other rows.
void AddControlRows(const AxisControl& control, const JointPose& pose, const JointRow& motion, double position,
                    float slackSpeed, uint32_t firstSlot, JointRowList& rows);

}  // namespace fulcrum
