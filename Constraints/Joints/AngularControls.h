// Rotation of B against A about three axes, each with limits, motor and friction: shared by swing-twist and six-dof
// joints, which call it. One thread per joint.
//
//   Coordinates (SwingTwist.h): twist about x, swing about y and z as the rotation vector phi. An axis is free, limited
//   or, where its limits are the same, locked. Axes that are hard and locked at zero from the start become a block:
//       all three: AngularLock::All
//       two:       AngularLock::Axis; the third is then as in a hinge, and counts turns
//   Else the rows are:
//       limits    C and axis from SwingTwist.h
//       motors    about the axes of B's frame. A target orientation g, made of the three target positions as swing and
//                 twist, gives q = g exp(c): C = c, a spring along the shortest way from anywhere. A target speed is
//                 that about the axis
//       friction  about the axes of B's frame
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>
#include <Fulcrum/Constraints/Parts/SwingTwist.h>

namespace fulcrum {

class AngularControls {
public:
    // x, y, z; rad, N m. Limits as SwingTwistLimits requires them: in -pi..pi, those of y and z contain 0, for an
    // ellipse they are symmetric.
    AngularControls(const std::array<AxisControl, 3>& axes, SwingShape shape);

    // Bounds of the limits of axis 0, 1, 2 (x, y, z).
    static LimitBounds BoundsOf(int axis, SwingShape shape);
    LimitBounds BoundsOf(int axis) const { return BoundsOf(axis, shape_); }

    AngularLock Lock() const { return lock_; }
    uint8_t FreeAxis() const { return freeAxis_; }  // for AngularLock::Axis
    uint32_t MaxRows() const;
    void Start(const JointPose& pose);
    // Each axis uses its own ControlSlots, starting at firstSlot.
    void CollectRows(const JointPose& pose, uint32_t firstSlot, JointRowList& rows);
    AxisControl& At(int axis) { return axes_[static_cast<size_t>(axis)]; }
    void SetTargetOrientation(const Quaternion& target);
    double Coordinate(int axis, const JointPose& pose) const;
    std::span<double> State() { return turns_.numbers; }
    void VisitSettings(const SettingVisitor& visit) {
        visit(shape_);
        visit(lock_);
        visit(freeAxis_);
    }
    SwingShape Shape() const { return shape_; }

private:
    struct Motion;
    SwingTwistLimits Limits() const;
    SwingTwistLimits HardLimits() const;
    Quaternion SwingWithin(const Quaternion& swing, const Vector3& phi, const SwingTwistLimits& limits) const;
    Vector3 SpeedsWithin(const SwingTwist& turned, const Vector3& speeds, float time,
                         const SwingTwistLimits& limits) const;
    Quaternion Target(const SwingTwistLimits& limits) const;
    Motion MotionOf(const JointPose& pose, const SwingTwistLimits& limits) const;
    void AddLimitRows(const JointPose& pose, const Motion& motion, const RotationLimitList& list, uint32_t firstSlot,
                      JointRowList& rows) const;
    void AddMotorRows(const JointPose& pose, const Motion& motion, const SwingTwist& turned,
                      const RotationLimitList& list, uint32_t firstSlot, JointRowList& rows) const;

    std::array<AxisControl, 3> axes_;
    SwingShape shape_;
    AngularLock lock_ = AngularLock::None;
    uint8_t freeAxis_ = 0;
    TurnCount turns_;
};

}  // namespace fulcrum
