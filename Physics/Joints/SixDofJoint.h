// Six-degrees-of-freedom joint: six axes, each free, limited or locked, hard or soft, with motors and friction.
//
//   translation  d = position of B's anchor along the axes of A's frame; rows as in SliderJoint.h
//   rotation     AngularControls.h
// Axes that are locked at zero and hard from the start become block parts where possible: three translations a point,
// two a line, rotations as in AngularControls.h. Other locked axes are rows of their own.
#pragma once

#include <Fulcrum/Constraints/Joints/AngularJointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A locked axis: `limited` with the default limits, both zero.
inline constexpr AxisControl kLockedAxis = {.limited = true};

// Each axis free, limited or locked (kLockedAxis; hard or, with a spring on its limits, soft), with motor and friction.
struct SixDofJointSettings : JointSettings {
    // In the order of JointAxis: m and N; rad and N m, rotations as in SwingTwistJointSettings.
    std::array<AxisControl, 6> axes{};
    SwingShape shape = SwingShape::Pyramid;

    // Aborts the program if there is no such axis.
    AxisControl& operator[](JointAxis axis) {
        if (axis > JointAxis::AngularZ) [[unlikely]]
            AbortWith("SixDofJointSettings has no axis of this number", "");
        return axes[static_cast<size_t>(axis)];
    }
};
MaybeError Check(const SixDofJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SixDofJointSettings& settings);

class SixDofJoint final : public AngularJointType {
public:
    // In the order of JointAxis; m and N, rad and N m. Limits of rotations as AngularControls requires them.
    SixDofJoint(const std::array<AxisControl, 6>& axes, SwingShape shape);

    const char* Kind() const override { return "six-dof"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override { return {linearLock_, angular_.Lock(), line_, angular_.FreeAxis()}; }
    uint32_t MaxRows() const override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    AxisControl* Control(JointAxis axis) override {
        return IsAngular(axis) ? AngularJointType::Control(axis) : &linear_[static_cast<size_t>(axis)];
    }
    uint32_t FirstSlot(JointAxis axis) const override { return static_cast<uint32_t>(axis) * ControlSlots::kCount; }
    void VisitSettings(const SettingVisitor& visit) override {
        AngularJointType::VisitSettings(visit);
        visit(linearLock_);
        visit(line_);
    }

private:
    // Whether the linear axis k has rows of its own, not only a lock.
    bool HasRows(uint8_t k) const {
        return linearLock_ == LinearLock::None || (linearLock_ == LinearLock::Line && k == line_);
    }

    std::array<AxisControl, 3> linear_;
    LinearLock linearLock_ = LinearLock::None;
    uint8_t line_ = 0;
};

}  // namespace fulcrum
