#include <Fulcrum/Constraints/Joints/AngularControls.h>

#include <algorithm>

namespace fulcrum {

namespace {

AngleRange RangeOf(const AxisControl& control) {
    if (!control.limited) return {};
    constexpr float kHalfTurn = AngleRange::kHalfTurn;
    return {std::clamp(control.limits.min, -kHalfTurn, kHalfTurn),
            std::clamp(control.limits.max, -kHalfTurn, kHalfTurn)};
}

// Whether a block part can hold the axis: locked at zero, hard.
bool HoldsZeroAngle(const AxisControl& control) {
    const AngleRange range = RangeOf(control);
    return control.limited && range.IsLocked() && Abs(range.Center()) < AngleRange::kNegligible &&
           IsHard(control.limits.spring);
}

size_t AxisOfLimit(RotationLimit::Slot slot) {
    return slot >= RotationLimit::TwistMaximum ? 0 : slot >= RotationLimit::SwingZMaximum ? 2 : 1;
}
uint32_t SlotOfLimit(RotationLimit::Slot slot) {
    const bool isMaximum = slot % 2 == 0;  // see the order of RotationLimit::Slot
    return static_cast<uint32_t>(AxisOfLimit(slot)) * ControlSlots::kCount +
           (isMaximum ? ControlSlots::kHighLimit : ControlSlots::kLowLimit);
}

// Locked axes have neither motor nor friction.
bool IsLocked(const AxisControl& control) { return control.limited && RangeOf(control).IsLocked(); }

bool IsLimited(const AngleRange& range) { return !range.IsLocked() && !range.IsFree(); }

// The swing clamped so that y / w and z / w are within the pyramid's faces.
Quaternion WithinPyramid(const Quaternion& swing, const SwingTwistLimits& limits) {
    const float y = swing.y / std::max(swing.w, 1e-6f), z = swing.z / std::max(swing.w, 1e-6f);
    const auto within = [](float ratio, const AngleRange& range) {
        // The tangent of a quarter turn is infinite.
        constexpr float kNearHalfTurn = AngleRange::kHalfTurn - 1e-3f;
        const SineCosine<float> low = SinCos(0.5f * std::max(range.minimum, -kNearHalfTurn));
        const SineCosine<float> high = SinCos(0.5f * std::min(range.maximum, kNearHalfTurn));
        return std::clamp(ratio, low.sine / low.cosine, high.sine / high.cosine);
    };
    const Quaternion clamped{0.0f, within(y, limits.swingY), within(z, limits.swingZ), 1.0f};
    return clamped.y == y && clamped.z == z ? swing : Normalized(clamped);
}

}  // namespace

// State shared by the rows of a step, world space.
struct AngularControls::Motion {
    Matrix3 axes;        // of frame B
    Vector3 toTarget;    // rotation vector from the target, along the axes
    Vector3 velocity;    // rad/s, of B against A
    Vector3 motorSpeed;  // rad/s, along the axes; zero where the motor has no target speed
    Vector3 motorVelocity;
};

AngularControls::AngularControls(const std::array<AxisControl, 3>& axes, SwingShape shape)
    : axes_(axes), shape_(shape) {
    int count = 0;
    for (uint8_t k = 0; k < 3; ++k) {
        if (HoldsZeroAngle(axes_[k])) ++count;
        else freeAxis_ = k;
    }
    if (count < 2) freeAxis_ = 0;
    lock_ = count == 3 ? AngularLock::All : count == 2 ? AngularLock::Axis : AngularLock::None;
}

LimitBounds AngularControls::BoundsOf(int axis, SwingShape shape) {
    constexpr float kHalfTurn = AngleRange::kHalfTurn;
    if (axis == 0) return {-kHalfTurn, kHalfTurn, -kHalfTurn, kHalfTurn, false};
    return {-kHalfTurn, 0.0f, 0.0f, kHalfTurn, shape == SwingShape::Ellipse};
}

SwingTwistLimits AngularControls::Limits() const {
    return {RangeOf(axes_[0]), RangeOf(axes_[1]), RangeOf(axes_[2]), shape_};
}

// Soft ones count as free.
SwingTwistLimits AngularControls::HardLimits() const {
    const auto range = [&](size_t axis) {
        return IsHard(axes_[axis].limits.spring) ? RangeOf(axes_[axis]) : AngleRange{};
    };
    return {range(0), range(1), range(2), shape_};
}

uint32_t AngularControls::MaxRows() const {
    if (lock_ == AngularLock::All) return 0;
    if (lock_ == AngularLock::Axis) return MaxControlRows(axes_[freeAxis_]);
    const SwingTwistLimits limits = Limits();
    const AngleRange &y = limits.swingY, &z = limits.swingZ;
    // As many as AddSwingLimits and AddTwistLimits add.
    uint32_t count = limits.twist.IsFree() ? 0 : limits.twist.IsLocked() ? 1 : 2;
    if (IsLimited(y) && IsLimited(z)) count += shape_ == SwingShape::Pyramid ? 4 : 1;
    else count += (IsLimited(y) || IsLimited(z) ? 2u : 0u) + (y.IsLocked() ? 1u : 0u) + (z.IsLocked() ? 1u : 0u);
    for (const AxisControl& axis : axes_)
        if (!IsLocked(axis)) count += (axis.motor.mode != MotorMode::Off ? 1u : 0u) + (axis.friction > 0.0f ? 1u : 0u);
    return count;
}

void AngularControls::Start(const JointPose& pose) { turns_.Start(AngleAbout(pose, freeAxis_), axes_[freeAxis_]); }

void AngularControls::SetTargetOrientation(const Quaternion& target) {
    const SwingTwist r = Decompose(target);
    axes_[0].motor.targetPosition = r.twist;
    axes_[1].motor.targetPosition = r.SwingY();
    axes_[2].motor.targetPosition = r.SwingZ();
    if (lock_ == AngularLock::Axis) {
        const Quaternion& q = target;
        axes_[freeAxis_].motor.targetPosition = TwistAngle({freeAxis_ == 0   ? q.x
                                                            : freeAxis_ == 1 ? q.y
                                                                             : q.z,
                                                            0.0f, 0.0f, q.w});
    }
}

// A swing beyond an ellipse or pyramid, moved to its edge; others as they are. phi: its rotation vector.
Quaternion AngularControls::SwingWithin(const Quaternion& swing, const Vector3& phi,
                                        const SwingTwistLimits& limits) const {
    const AngleRange &y = limits.swingY, &z = limits.swingZ;
    if (!IsLimited(y) || !IsLimited(z)) return swing;
    if (shape_ == SwingShape::Pyramid) return WithinPyramid(swing, limits);
    const float ofY = phi.y() / y.maximum, ofZ = phi.z() / z.maximum, squared = ofY * ofY + ofZ * ofZ;
    return squared > 1.0f ? RotationFromVector(Vector3(phi * (1.0f / Sqrt(squared)))) : swing;
}

// The target positions as an orientation, clamped to the limits.
Quaternion AngularControls::Target(const SwingTwistLimits& limits) const {
    const float twist = std::clamp(axes_[0].motor.targetPosition, limits.twist.minimum, limits.twist.maximum);
    Vector3 phi(0.0f, axes_[1].motor.targetPosition, axes_[2].motor.targetPosition);
    const AngleRange &y = limits.swingY, &z = limits.swingZ;
    if (!IsLimited(y) || !IsLimited(z)) {
        phi.y() = std::clamp(phi.y(), y.minimum, y.maximum);
        phi.z() = std::clamp(phi.z(), z.minimum, z.maximum);
    }
    return SwingWithin(RotationFromVector(phi), phi, limits) * RotationFromVector(Vector3(twist, 0.0f, 0.0f));
}

// The target speeds, along the axes of B, so that within `time` they lead no farther than the limits are: to the
// nearest orientation within from where they would lead without. So at an edge they slide along it, to its end in their
// direction.
Vector3 AngularControls::SpeedsWithin(const SwingTwist& turned, const Vector3& speeds, float time,
                                      const SwingTwistLimits& limits) const {
    constexpr float kQuarterTurn = 0.5f * AngleRange::kHalfTurn;  // farther away the nearest edge limits them
    const Vector3 swing(0.0f, speeds.y(), speeds.z());
    const float part = std::min(time, kQuarterTurn / std::max(Length(swing), 1e-6f));
    const auto swingWithin = [&](const SwingTwist& r) {
        return SwingWithin(r.swing, Vector3(0.0f, r.SwingY(), r.SwingZ()), limits);
    };
    const auto twistWithin = [&](float twist) {
        const AngleRange& range = limits.twist;
        return range.IsFree() ? twist : std::clamp(twist, range.minimum, range.maximum);
    };
    const auto withTwist = [](const Quaternion& of, float twist) {
        return of * RotationFromVector(Vector3(twist, 0.0f, 0.0f));
    };
    // What is beyond a limit moves as at the limit: it is not for motors to correct that.
    const float center = limits.twist.Center();
    const Quaternion from = withTwist(swingWithin(turned), twistWithin(detail::Unwrapped(turned.twist, center)));
    const SwingTwist to = Decompose(from * RotationFromVector(Vector3(swing * part)));
    const float twist = detail::Unwrapped(to.twist, center), turn = speeds.x() * time, end = twistWithin(twist + turn);
    const Quaternion endSwing = swingWithin(to);
    if (end == twist + turn && endSwing.y == to.swing.y && endSwing.z == to.swing.z) return speeds;
    const Vector3 way = RotationVectorOf<float>(from.Conjugate() * withTwist(endSwing, twist));
    return Vector3(way.x() + (end - twist), way.y(), way.z()) * (1.0f / time);
}

AngularControls::Motion AngularControls::MotionOf(const JointPose& pose, const SwingTwistLimits& limits) const {
    const Quaternion q = pose.frameA.Conjugate() * pose.frameB;
    Motion motion;
    motion.axes = ToMatrix(pose.frameB);
    motion.velocity = pose.AngularVelocity();
    motion.toTarget = motion.motorSpeed = Vector3::Zero();
    const auto hasPosition = [](const AxisControl& axis) { return axis.motor.mode == MotorMode::ToPosition; };
    if (std::any_of(axes_.begin(), axes_.end(), hasPosition))
        motion.toTarget = RotationVectorOf<float>(Target(limits).Conjugate() * q);
    for (int k = 0; k < 3; ++k) {
        const AxisControl& control = axes_[static_cast<size_t>(k)];
        const MotorMode mode = IsLocked(control) ? MotorMode::Off : control.motor.mode;
        if (mode == MotorMode::ToVelocity) motion.motorSpeed[k] = control.motor.targetSpeed;
        if (mode != MotorMode::ToPosition) motion.toTarget[k] = 0.0f;
    }
    motion.motorVelocity = motion.axes * motion.motorSpeed;
    return motion;
}

void AngularControls::CollectRows(const JointPose& pose, uint32_t firstSlot, JointRowList& rows) {
    if (lock_ == AngularLock::All) return;
    if (lock_ == AngularLock::Axis) {
        const Vector3 axis = AxisAbout(pose, freeAxis_);
        JointRow motion;
        pose.SetAbout(motion, axis);
        turns_.Advance(AngleAbout(pose, freeAxis_), pose.TurnedAbout(axis));
        const AxisControl& control = axes_[freeAxis_];
        const bool isFree = RangeOf(control).IsFree() || IsTilted(pose, freeAxis_);
        return AddControlRows(isFree ? WithoutLimits(control) : control, pose, motion, turns_.Angle(),
                              kAngularSlackSpeed, firstSlot + freeAxis_ * ControlSlots::kCount, rows);
    }
    const SwingTwistLimits limits = Limits();
    const Motion motion = MotionOf(pose, limits);
    RotationLimitList list;
    // Edges out of reach are skipped: an ellipse and a pyramid contain the circle of their smallest angle.
    float reach = (1.25f * std::max(Length(motion.velocity), Length(motion.motorSpeed)) + kAngularSlackSpeed) * pose.dt;
    for (int k = 0; k < 3; ++k)
        reach += SpringTravel(axes_[static_cast<size_t>(k)].motor.spring, Abs(motion.toTarget[k]), pose.dt);
    const AngleRange &y = limits.swingY, &z = limits.swingZ;
    const SwingTwist turned = Decompose(pose.frameA.Conjugate() * pose.frameB);
    const float least = std::min({y.maximum, -y.minimum, z.maximum, -z.minimum});
    if (pose.isDirect || !IsLimited(y) || !IsLimited(z) || least - turned.alpha <= reach)
        AddSwingLimits(list, turned, limits);
    // If the x axes are nearly opposite, twist is ill-defined, and its limit may work against the swing limit that
    // reduces the swing.
    constexpr float kOpposite = 0.3f, kFarOut = 0.5f;  // cos(alpha / 2); rad
    const bool isSwungFar =
        turned.swing.w < kOpposite &&
        std::any_of(list.begin(), list.end(), [](const RotationLimit& limit) { return limit.error < -kFarOut; });
    if (!isSwungFar) AddTwistLimits(list, turned, limits.twist);
    // Transforms the limit to world space.
    for (int i = 0; i < list.count; ++i) {
        RotationLimit& limit = list.limits[static_cast<size_t>(i)];
        limit.axis = Rotate(pose.frameA, limit.axis);
        limit.pole = Rotate(pose.frameA, limit.pole);
    }
    AddMotorRows(pose, motion, turned, list, firstSlot, rows);
    AddLimitRows(pose, motion, list, firstSlot, rows);
}

void AngularControls::AddLimitRows(const JointPose& pose, const Motion& motion, const RotationLimitList& list,
                                   uint32_t firstSlot, JointRowList& rows) const {
    const Vector3 ofA = ToMatrix(pose.frameA).x, ofB = motion.axes.x;  // the x axes of both frames
    for (const RotationLimit& limit : list) {
        const size_t axis = AxisOfLimit(limit.slot);
        const SpringSettings& spring = axes_[axis].limits.spring;
        JointRow row;
        pose.SetAbout(row, limit.axis);
        if (axis == 0) {
            pose.SetPivot(row, JointRow::Pivot::Between, ofA, ofB);
        } else if (!limit.pole.isZero(0)) {
            // Of an edge that is not reached yet the axis is that of its nearest point.
            const Vector3 nearest = ofB - limit.axis * Dot(limit.axis, ofB);
            pose.SetPivot(row, JointRow::Pivot::Across, limit.pole, Normalized(nearest, ofB));
        }
        if (limit.isLocked) {
            AddLockRow(spring, row, limit.error, firstSlot + SlotOfLimit(limit.slot), rows);
            continue;
        }
        // The swing may reach a curved edge by moving sideways, so its whole speed counts.
        const float closing = axis == 0 ? -Dot(limit.axis, motion.velocity) : Length(motion.velocity);
        const float speed = std::max({0.0f, closing, -Dot(limit.axis, motion.motorVelocity)});
        float reach = (1.25f * speed + kAngularSlackSpeed) * pose.dt;
        for (int k = 0; k < 3; ++k) {
            const float way = motion.toTarget[k] * Dot(limit.axis, AxisOf(motion.axes, k));
            reach += SpringTravel(axes_[static_cast<size_t>(k)].motor.spring, std::max(0.0f, way), pose.dt);
        }
        if (limit.error > reach && !pose.isDirect) continue;
        AddLimitRow(spring, row, 1.0f, limit.error, firstSlot + SlotOfLimit(limit.slot), rows);
    }
}

// As in AddControlRows: the target speed is clamped to what hard limits allow, and a motor well beyond a limit does not
// hold the axis there.
void AngularControls::AddMotorRows(const JointPose& pose, const Motion& motion, const SwingTwist& turned,
                                   const RotationLimitList& list, uint32_t firstSlot, JointRowList& rows) const {
    const float time = pose.dt + pose.substepDt;
    Vector3 allowed = motion.motorVelocity;
    if (list.count > 0 && !motion.motorSpeed.isZero(0))
        allowed = motion.axes * SpeedsWithin(turned, motion.motorSpeed, time, HardLimits());
    for (const RotationLimit& limit : list) {
        if (limit.isLocked || !IsHard(axes_[AxisOfLimit(limit.slot)].limits.spring)) continue;
        const float slowest = -std::max(limit.error, -kLimitSlop) / time, speed = Dot(limit.axis, allowed);
        if (speed < slowest) allowed += limit.axis * (slowest - speed);
    }
    for (int k = 0; k < 3; ++k) {
        const AxisControl& control = axes_[static_cast<size_t>(k)];
        if (IsLocked(control)) continue;
        const JointMotor& motor = control.motor;
        const Vector3& axis = AxisOf(motion.axes, k);
        const uint32_t slot = firstSlot + static_cast<uint32_t>(k) * ControlSlots::kCount;
        if (control.friction > 0.0f) {
            JointRow& row = rows.Add(slot + ControlSlots::kFriction, JointRow::Kind::Speed);
            pose.SetAbout(row, axis);
            row.minForce = -control.friction;
            row.maxForce = control.friction;
        }
        if (motor.mode == MotorMode::Off) continue;
        const bool isPosition = motor.mode == MotorMode::ToPosition;
        const auto kind = !isPosition            ? JointRow::Kind::Speed
                          : IsHard(motor.spring) ? JointRow::Kind::Equal
                                                 : JointRow::Kind::Spring;
        JointRow& row = rows.Add(slot + ControlSlots::kMotor, kind);
        pose.SetAbout(row, axis);
        row.minForce = motor.minForce;
        row.maxForce = motor.maxForce;
        row.spring = motor.spring;
        row.error = motion.toTarget[k];
        if (isPosition) continue;
        row.speed = Dot(axis, allowed);
        row.isStopped = motor.targetSpeed == 0.0f;
        for (const RotationLimit& limit : list) {
            if (limit.isLocked) continue;
            const float along = Dot(axis, limit.axis);
            row.isStopped |=
                limit.error < kLimitSlop && along * motor.targetSpeed < 0.0f && row.speed != motor.targetSpeed;
            if (limit.error >= -kLimitSlop) continue;
            if (along < -0.3f) row.maxForce = 0.0f;
            if (along > 0.3f) row.minForce = 0.0f;
        }
    }
}

double AngularControls::Coordinate(int axis, const JointPose& pose) const {
    if (lock_ == AngularLock::Axis && axis == freeAxis_)
        return turns_.After(AngleAbout(pose, axis), pose.TurnedAbout(AxisAbout(pose, axis)));
    const SwingTwist r = Decompose(pose.frameA.Conjugate() * pose.frameB);
    return axis == 0 ? r.twist : axis == 1 ? r.SwingY() : r.SwingZ();
}

}  // namespace fulcrum
