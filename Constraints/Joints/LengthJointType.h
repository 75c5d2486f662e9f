// Base of the joint types that keep one length in a range (LinearX), with a motor that changes it: distance joints and
// pulleys. One thread per joint.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>

namespace fulcrum {

class LengthJointType : public JointType {
public:
    uint32_t MaxRows() const override { return MaxControlRows(control_); }
    AxisControl* Control(JointAxis axis) override { return axis == JointAxis::LinearX ? &control_ : nullptr; }
    LimitBounds BoundsOf(JointAxis) const override { return {.lowest = 0.0f}; }
    double Coordinate(JointAxis axis, const JointPose& pose) const override {
        return axis == JointAxis::LinearX ? static_cast<double>(LengthAt(pose)) : JointType::Coordinate(axis, pose);
    }
    void VisitSettings(const SettingVisitor& visit) override { visit(isMeasured_); }

protected:
    // isMeasured: Start sets limits from the length when the joint is created.
    LengthJointType(const JointLimits& limits, bool isMeasured) : isMeasured_(isMeasured) {
        control_.limited = true;
        control_.limits = limits;
    }

    // m, >= 0.
    virtual float LengthAt(const JointPose& pose) const = 0;

    AxisControl control_;
    bool isMeasured_;
};

}  // namespace fulcrum
