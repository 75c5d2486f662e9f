#include <Fulcrum/Physics/Joints/WheelJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <algorithm>

namespace fulcrum {

namespace {

struct WheelSlots {
    static constexpr uint32_t kSuspension = 0, kSteering = 4, kSpin = 8, kTilt = 12;
};

struct WheelAngles {
    float steering, tilt, spin;                // rad
    Vector3 steeringAxis, tiltAxis, spinAxis;  // Jacobians with respect to the relative angular velocity
};

WheelAngles AnglesOf(const JointPose& pose) {
    const Matrix3 a = ToMatrix(pose.frameA), b = ToMatrix(pose.frameB);
    const Vector3& d = b.x;
    const float s = Dot(d, a.y);
    WheelAngles angles;
    angles.steering = Atan2(-Dot(d, a.z), Dot(d, a.x));
    // The wheel carrier's frame, which does not spin: d, `up` and `side`.
    const Vector3 side = Normalized(Cross(d, a.y), a.z);
    const Vector3 up = Cross(side, d);
    angles.tilt = Atan2(s, Length(Cross(d, a.y)));
    angles.spin = Atan2(Dot(b.y, side), Dot(b.y, up));
    angles.steeringAxis = (a.y - d * s) * (1.0f / std::max(1.0f - s * s, 1e-3f));
    angles.tiltAxis = side;
    angles.spinAxis = d - angles.steeringAxis * s;
    return angles;
}

}  // namespace

MaybeError Check(const WheelJointSettings& s) {
    return CheckWith(s, CheckControl("suspension", s.suspension), CheckControl("steering", s.steering),
                     CheckControl("spin", s.spin));
}

std::unique_ptr<JointType> MakeType(const WheelJointSettings& s) {
    return std::make_unique<WheelJoint>(s.suspension, s.isSteered, s.steering, s.spin);
}

WheelJoint::WheelJoint(const AxisControl& suspension, bool isSteered, const AxisControl& steering,
                       const AxisControl& spin)
    : suspension_(suspension), steering_(steering), spin_(spin), isSteered_(isSteered) {}

JointLocks WheelJoint::Locks() const {
    return {LinearLock::Line, isSteered_ ? AngularLock::None : AngularLock::Axis, 1, 0};
}

uint32_t WheelJoint::MaxRows() const {
    return MaxControlRows(suspension_) + MaxControlRows(spin_) + (isSteered_ ? 1 + MaxControlRows(steering_) : 0);
}

void WheelJoint::Start(const JointPose& pose) { turns_.Start(AnglesOf(pose).spin, spin_); }

void WheelJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const WheelAngles angles = AnglesOf(pose);
    JointRow motion;
    pose.SetAbout(motion, angles.spinAxis);
    turns_.Advance(angles.spin, pose.TurnedAbout(angles.spinAxis));
    AddControlRows(spin_, pose, motion, turns_.Angle(), kAngularSlackSpeed, WheelSlots::kSpin, rows);
    if (isSteered_) {
        pose.SetAbout(motion, angles.steeringAxis);
        AddControlRows(steering_, pose, motion, angles.steering, kAngularSlackSpeed, WheelSlots::kSteering, rows);
        JointRow& tilt = rows.Add(WheelSlots::kTilt, JointRow::Kind::Equal);
        pose.SetAbout(tilt, angles.tiltAxis);
        tilt.error = angles.tilt;
    }
    JointRow slide;
    const Vector3 axis = ToMatrix(pose.frameA).y;
    pose.SetAlong(slide, axis);
    AddControlRows(suspension_, pose, slide, Dot(pose.offset, axis), kLinearSlackSpeed, WheelSlots::kSuspension, rows);
}

AxisControl* WheelJoint::Control(JointAxis axis) {
    if (axis == JointAxis::LinearY) return &suspension_;
    if (axis == JointAxis::AngularY) return isSteered_ ? &steering_ : nullptr;
    return axis == JointAxis::AngularX ? &spin_ : nullptr;
}

uint32_t WheelJoint::FirstSlot(JointAxis axis) const {
    return axis == JointAxis::AngularY   ? WheelSlots::kSteering
           : axis == JointAxis::AngularX ? WheelSlots::kSpin
                                         : WheelSlots::kSuspension;
}

double WheelJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    if (axis < JointAxis::AngularX) return JointType::Coordinate(axis, pose);
    const WheelAngles angles = AnglesOf(pose);
    if (axis == JointAxis::AngularY) return angles.steering;
    if (axis == JointAxis::AngularZ) return angles.tilt;
    return turns_.After(angles.spin, pose.TurnedAbout(angles.spinAxis));
}

JointDrawing WheelJoint::Drawing() const { return {.steering = isSteered_, .trackA = 1, .circleB = 0.0f}; }

}  // namespace fulcrum
