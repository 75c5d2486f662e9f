#include <Fulcrum/Physics/Joints/SixDofJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

namespace {

bool IsLockedAtZero(const AxisControl& control) {
    return control.limited && control.limits.min == 0.0f && control.limits.max == 0.0f && IsHard(control.limits.spring);
}

}  // namespace

MaybeError Check(const SixDofJointSettings& s) {
    if (MaybeError e = CheckWith(s, CheckControl("axes[LinearX]", s.axes[0]), CheckControl("axes[LinearY]", s.axes[1]),
                                 CheckControl("axes[LinearZ]", s.axes[2])))
        return e;
    return CheckSwingTwist({"axes[AngularX]", "axes[AngularY]", "axes[AngularZ]"}, {s.axes[3], s.axes[4], s.axes[5]},
                           s.shape);
}

std::unique_ptr<JointType> MakeType(const SixDofJointSettings& s) {
    return std::make_unique<SixDofJoint>(s.axes, s.shape);
}

SixDofJoint::SixDofJoint(const std::array<AxisControl, 6>& axes, SwingShape shape)
    : AngularJointType({axes[3], axes[4], axes[5]}, shape, 3 * ControlSlots::kCount),
      linear_{axes[0], axes[1], axes[2]} {
    int count = 0;
    for (uint8_t k = 0; k < 3; ++k) {
        if (IsLockedAtZero(linear_[k])) ++count;
        else line_ = k;
    }
    if (count != 2) line_ = 0;
    linearLock_ = count == 3 ? LinearLock::Point : count == 2 ? LinearLock::Line : LinearLock::None;
}

uint32_t SixDofJoint::MaxRows() const {
    uint32_t count = angular_.MaxRows();
    for (uint8_t k = 0; k < 3; ++k)
        if (HasRows(k)) count += MaxControlRows(linear_[k]);
    return count;
}

void SixDofJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    angular_.CollectRows(pose, firstAngularSlot_, rows);
    const Matrix3 frame = ToMatrix(pose.frameA);
    for (uint8_t k = 0; k < 3; ++k) {
        if (!HasRows(k)) continue;
        const Vector3& axis = AxisOf(frame, k);
        JointRow motion;
        pose.SetAlong(motion, axis);
        AddControlRows(linear_[k], pose, motion, Dot(pose.offset, axis), kLinearSlackSpeed, k * ControlSlots::kCount,
                       rows);
    }
}

JointDrawing SixDofJoint::Drawing() const {
    return {.rotations = true, .translations = true, .isPyramid = angular_.Shape() == SwingShape::Pyramid};
}

}  // namespace fulcrum
