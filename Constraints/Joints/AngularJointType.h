// Base of the joint types whose rotation is that of AngularControls: swing-twist and six-dof joints. One thread per
// joint.
#pragma once

#include <Fulcrum/Constraints/Joints/AngularControls.h>

namespace fulcrum {

class AngularJointType : public JointType {
public:
    void Start(const JointPose& pose) override { angular_.Start(pose); }
    AxisControl* Control(JointAxis axis) override { return IsAngular(axis) ? &angular_.At(IndexOf(axis)) : nullptr; }
    LimitBounds BoundsOf(JointAxis axis) const override {
        return IsAngular(axis) ? angular_.BoundsOf(IndexOf(axis)) : LimitBounds{};
    }
    uint32_t FirstSlot(JointAxis axis) const override {
        return IsAngular(axis) ? firstAngularSlot_ + static_cast<uint32_t>(IndexOf(axis)) * ControlSlots::kCount : 0;
    }
    void SetTargetOrientation(const Quaternion& target) override { angular_.SetTargetOrientation(target); }
    double Coordinate(JointAxis axis, const JointPose& pose) const override {
        return IsAngular(axis) ? angular_.Coordinate(IndexOf(axis), pose) : JointType::Coordinate(axis, pose);
    }
    std::span<double> State() override { return angular_.State(); }
    void VisitSettings(const SettingVisitor& visit) override { angular_.VisitSettings(visit); }

protected:
    // Axes in the order x, y, z; rad, N m; limits as AngularControls requires them.
    AngularJointType(const std::array<AxisControl, 3>& axes, SwingShape shape, uint32_t firstAngularSlot)
        : angular_(axes, shape), firstAngularSlot_(firstAngularSlot) {}

    static bool IsAngular(JointAxis axis) { return axis >= JointAxis::AngularX; }

    AngularControls angular_;
    uint32_t firstAngularSlot_;

private:
    static int IndexOf(JointAxis axis) { return static_cast<int>(axis) - static_cast<int>(JointAxis::AngularX); }
};

}  // namespace fulcrum
