// Slider joint: B's anchor moves along the x axis of A's frame, and B does not rotate relative to A; with limits, motor
// and friction.
//
//   d           distance from A's anchor to B's along x            x  unit axis, moving with A
//   Locks:      line along x; all rotation
//   Rows:       C = d - ..., J = [-x, -(r1 + u) x x, x, r2 x x] (LinearX)
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// B slides along the anchor's axis and does not rotate relative to A.
struct SliderJointSettings : JointSettings {
    AxisControl slide{};  // m, m/s, N
};
MaybeError Check(const SliderJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SliderJointSettings& settings);

class SliderJoint final : public JointType {
public:
    explicit SliderJoint(const AxisControl& slide) : control_(slide) {}  // m, N

    const char* Kind() const override { return "slider"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override { return {LinearLock::Line, AngularLock::All, 0, 0}; }
    uint32_t MaxRows() const override { return MaxControlRows(control_); }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        const Vector3 axis = ToMatrix(pose.frameA).x;
        JointRow motion;
        pose.SetAlong(motion, axis);
        AddControlRows(control_, pose, motion, Dot(pose.offset, axis), kLinearSlackSpeed, 0, rows);
    }
    AxisControl* Control(JointAxis axis) override { return axis == JointAxis::LinearX ? &control_ : nullptr; }

private:
    AxisControl control_;
};

}  // namespace fulcrum
