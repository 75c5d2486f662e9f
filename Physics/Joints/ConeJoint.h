// Cone joint: B's anchor stays at A's, and the x axis of B's frame stays within an angle of A's; B rotates about it
// freely.
//
//   alpha       angle between the two x axes, 0..pi           e  unit axis from A's x to B's: xA cross xB / sin(alpha)
//   Locks:      point; for a half angle of zero also rotation about y and z
//   Rows:       C = halfAngle - alpha >= 0, J = [0, e, 0, -e]
// Where the axes are parallel or opposite, e is any axis perpendicular to x.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A point joint whose axes stay within an angle of each other; B rotates about its axis freely.
struct ConeJointSettings : JointSettings {
    float halfAngle = 0.785398163f;  // rad, 0..pi; pi: no limit
    SpringSettings spring{};         // of the limit
};
MaybeError Check(const ConeJointSettings& settings);
std::unique_ptr<JointType> MakeType(const ConeJointSettings& settings);

class ConeJoint final : public JointType {
public:
    // halfAngle: 0..pi rad, at pi there is no limit. The spring is that of the limit.
    ConeJoint(float halfAngle, const SpringSettings& spring);

    const char* Kind() const override { return "cone"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override;
    uint32_t MaxRows() const override { return IsAxle() || IsFree() ? 0 : MaxControlRows(control_); }
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    // AngularY: alpha, rad. Not a rotation about a fixed axis, so there is neither friction nor motor.
    double Coordinate(JointAxis axis, const JointPose& pose) const override;
    void VisitSettings(const SettingVisitor& visit) override {
        visit(control_.limits.max);
        visit(control_.limits.spring);
    }
    float HalfAngle() const { return control_.limits.max; }  // rad

private:
    bool IsAxle() const;
    bool IsFree() const;

    AxisControl control_;
};

}  // namespace fulcrum
