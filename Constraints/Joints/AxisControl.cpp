#include <Fulcrum/Constraints/Joints/AxisControl.h>

#include <Fulcrum/Constraints/Joints/JointType.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Adds a row with the Jacobian of `motion` times sign.
JointRow& AddRow(const JointRow& motion, float sign, uint32_t slot, JointRow::Kind kind, JointRowList& rows) {
    JointRow& row = rows.Add(slot, kind);
    const RowJacobian<float>& j = motion.jacobian;
    row.jacobian = {{j.a.linear * sign, j.a.angular * sign}, {j.b.linear * sign, j.b.angular * sign}};
    row.turnsWithA = motion.turnsWithA;
    row.radial = motion.radial;
    row.pivot = motion.pivot;
    row.ofA = motion.ofA;
    row.ofB = motion.ofB;
    row.about = motion.about;
    return row;
}

bool LimitsLock(const AxisControl& control) { return control.limited && control.limits.min >= control.limits.max; }

// Upper bound of the position that the axis may reach within the step in the direction of `sign`.
float Reach(const AxisControl& control, double position, float speed, float sign, float slackSpeed,
            const JointPose& pose) {
    if (pose.isDirect) return std::numeric_limits<float>::max();
    const JointMotor& motor = control.motor;
    float closing = std::max(0.0f, sign * speed);
    if (motor.mode == MotorMode::ToVelocity) closing = std::max(closing, sign * motor.targetSpeed);
    float reach = (1.25f * closing + slackSpeed) * pose.dt;
    if (motor.mode == MotorMode::ToPosition) {
        const float target = std::clamp(motor.targetPosition, control.limits.min, control.limits.max);
        reach += SpringTravel(motor.spring, std::max(0.0f, sign * static_cast<float>(target - position)), pose.dt);
    }
    return reach;
}

void AddMotorRow(const AxisControl& control, const JointRow& motion, double position, float timeToLimit, uint32_t slot,
                 JointRowList& rows) {
    const JointMotor& motor = control.motor;
    if (motor.mode == MotorMode::ToPosition) {
        const double target = control.limited ? std::clamp(motor.targetPosition, control.limits.min, control.limits.max)
                                              : motor.targetPosition;
        // Beyond a hard stop the spring pulls no more than at the stop.
        if (control.limited && IsHard(control.limits.spring))
            position = std::clamp(position, static_cast<double>(control.limits.min - kLimitSlop),
                                  static_cast<double>(control.limits.max + kLimitSlop));
        AddLockRow(motor.spring, motion, static_cast<float>(position - target), slot, rows);
        JointRow& row = rows.rows[rows.count - 1];
        row.minForce = motor.minForce;
        row.maxForce = motor.maxForce;
        return;
    }
    JointRow& row = AddRow(motion, 1.0f, slot, JointRow::Kind::Speed, rows);
    row.speed = motor.targetSpeed;
    row.minForce = motor.minForce;
    row.maxForce = motor.maxForce;
    row.isStopped = motor.targetSpeed == 0.0f;
    if (!control.limited || !IsHard(control.limits.spring)) return;
    // A motor that works against a hard stop would let both rows' impulses grow without bound. So its target speed is
    // at most what the limit allows: reaching the limit one substep later. Well beyond the limit the motor must not
    // resist the limit's correction.
    const float below = static_cast<float>(control.limits.max - position);
    const float above = static_cast<float>(position - control.limits.min);
    row.speed = std::min(row.speed, std::max(below, -kLimitSlop) / timeToLimit);
    row.speed = std::max(row.speed, -std::max(above, -kLimitSlop) / timeToLimit);
    row.isStopped |= row.speed != motor.targetSpeed && (motor.targetSpeed > 0.0f ? below : above) < kLimitSlop;
    if (below < -kLimitSlop) row.maxForce = 0.0f;
    if (above < -kLimitSlop) row.minForce = 0.0f;
}

}  // namespace

float SpringTravel(const SpringSettings& spring, float distance, float dt) {
    if (IsHard(spring)) return distance;
    if (spring.mode == SpringMode::StiffnessAndDamping)
        return 2.0f * distance;  // upper bound, since the mass is unknown here
    const float phase = 6.28318531f * spring.frequency * dt;
    return distance * std::min(2.0f, 0.5f * phase * phase);
}

float StretchSpeed(float distance, float speed, float dt) {
    return speed * std::min(1.0f, speed * dt / std::max(distance, 1e-6f));
}

JointRow& AddLimitRow(const SpringSettings& spring, const JointRow& motion, float sign, float error, uint32_t slot,
                      JointRowList& rows) {
    JointRow& row =
        AddRow(motion, sign, slot, IsHard(spring) ? JointRow::Kind::AtLeast : JointRow::Kind::SpringAtLeast, rows);
    row.error = error;
    row.spring = spring;
    row.minForce = 0.0f;
    return row;
}

void AddLockRow(const SpringSettings& spring, const JointRow& motion, float error, uint32_t slot, JointRowList& rows) {
    JointRow& row = AddRow(motion, 1.0f, slot, IsHard(spring) ? JointRow::Kind::Equal : JointRow::Kind::Spring, rows);
    row.error = error;
    row.spring = spring;
}

uint32_t MaxControlRows(const AxisControl& control) {
    if (LimitsLock(control)) return 1;
    return (control.limited ? 2u : 0u) + (control.motor.mode != MotorMode::Off ? 1u : 0u) +
           (control.friction > 0.0f ? 1u : 0u);
}

AxisControl WithoutLimits(const AxisControl& control) {
    if (LimitsLock(control)) return {};
    AxisControl free = control;
    free.limited = false;
    return free;
}

void AddControlRows(const AxisControl& control, const JointPose& pose, const JointRow& motion, double position,
                    float slackSpeed, uint32_t firstSlot, JointRowList& rows) {
    const JointLimits& limits = control.limits;
    if (LimitsLock(control)) {
        const auto error = static_cast<float>(position - limits.min);
        return AddLockRow(limits.spring, motion, error, firstSlot + ControlSlots::kLowLimit, rows);
    }
    if (control.friction > 0.0f) {
        JointRow& row = AddRow(motion, 1.0f, firstSlot + ControlSlots::kFriction, JointRow::Kind::Speed, rows);
        row.minForce = -control.friction;
        row.maxForce = control.friction;
    }
    if (control.motor.mode != MotorMode::Off)
        AddMotorRow(control, motion, position, pose.dt + pose.substepDt, firstSlot + ControlSlots::kMotor, rows);
    if (!control.limited) return;
    const float speed = pose.SpeedOf(motion);
    const float above = static_cast<float>(position - limits.min), below = static_cast<float>(limits.max - position);
    if (above <= Reach(control, position, speed, -1.0f, slackSpeed, pose))
        AddLimitRow(limits.spring, motion, 1.0f, above, firstSlot + ControlSlots::kLowLimit, rows);
    if (below <= Reach(control, position, speed, 1.0f, slackSpeed, pose))
        AddLimitRow(limits.spring, motion, -1.0f, below, firstSlot + ControlSlots::kHighLimit, rows);
}

}  // namespace fulcrum
