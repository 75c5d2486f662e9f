// Hinge joint: B rotates relative to A about the x axis of the frames, with limits, motor and friction.
//
//   theta       rotation of frame B relative to frame A about +x, counted over any number of revolutions
//   Locks:      point; rotation but about x
//   Rows:       C = theta - ..., J = [0, -a, 0, a], a the hinge axis (AngularX)
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// B rotates about the anchor's axis. The angle is the rotation of B relative to A about it, zero if the frames
// coincide; counted over any number of revolutions if it has limits, a motor or friction.
struct HingeJointSettings : JointSettings {
    AxisControl angle{};  // rad, rad/s, N m
};
MaybeError Check(const HingeJointSettings& settings);
std::unique_ptr<JointType> MakeType(const HingeJointSettings& settings);

class HingeJoint final : public JointType {
public:
    // rad, N m. Limits may be any number of revolutions from zero: counting starts at the revolution nearest to them.
    explicit HingeJoint(const AxisControl& angle) : control_(angle) {}

    const char* Kind() const override { return "hinge"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override { return {LinearLock::Point, AngularLock::Axis, 0, 0}; }
    uint32_t MaxRows() const override { return MaxControlRows(control_); }
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    AxisControl* Control(JointAxis axis) override { return axis == JointAxis::AngularX ? &control_ : nullptr; }
    double Coordinate(JointAxis axis, const JointPose& pose) const override;
    std::span<double> State() override { return turns_.numbers; }

private:
    AxisControl control_;
    TurnCount turns_;
};

}  // namespace fulcrum
