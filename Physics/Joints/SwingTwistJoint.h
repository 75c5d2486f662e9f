// Swing-twist joint (shoulder): B's anchor stays at A's, B's x axis swings within an ellipse or a pyramid about A's,
// and B twists about it within a range; motors and friction about all axes.
//   Locks:      point; rotation as far as axes are locked (AngularControls.h)
//   Rows:       AngularControls.h (AngularX the twist, AngularY and AngularZ the swing)
#pragma once

#include <Fulcrum/Constraints/Joints/AngularJointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A point joint for shoulders: B's axis (x) swings about A's y and z in an ellipse or a pyramid, and B twists about it.
struct SwingTwistJointSettings : JointSettings {
    SwingShape shape = SwingShape::Ellipse;
    // rad, N m. Limits within -pi..pi; pi means no limit. Those of the swing apply to y and z of its rotation vector
    // and contain 0; for an ellipse they are symmetric: -a..a, -b..b.
    AxisControl twist{}, swingY{}, swingZ{};
};
MaybeError Check(const SwingTwistJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SwingTwistJointSettings& settings);

class SwingTwistJoint final : public AngularJointType {
public:
    // rad, N m; limits as AngularControls requires them.
    SwingTwistJoint(const AxisControl& twist, const AxisControl& swingY, const AxisControl& swingZ, SwingShape shape)
        : AngularJointType({twist, swingY, swingZ}, shape, 0) {}

    const char* Kind() const override { return "swing-twist"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override { return {LinearLock::Point, angular_.Lock(), 0, angular_.FreeAxis()}; }
    uint32_t MaxRows() const override { return angular_.MaxRows(); }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        angular_.CollectRows(pose, firstAngularSlot_, rows);
    }
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
};

}  // namespace fulcrum
