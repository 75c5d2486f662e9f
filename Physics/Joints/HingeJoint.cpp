#include <Fulcrum/Physics/Joints/HingeJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const HingeJointSettings& s) { return CheckWith(s, CheckControl("angle", s.angle)); }

std::unique_ptr<JointType> MakeType(const HingeJointSettings& s) { return std::make_unique<HingeJoint>(s.angle); }

void HingeJoint::Start(const JointPose& pose) { turns_.Start(AngleAbout(pose, 0), control_); }

void HingeJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const Vector3 axis = AxisAbout(pose, 0);
    JointRow motion;
    pose.SetAbout(motion, axis);
    turns_.Advance(AngleAbout(pose, 0), pose.TurnedAbout(axis));
    AddControlRows(IsTilted(pose, 0) ? WithoutLimits(control_) : control_, pose, motion, turns_.Angle(),
                   kAngularSlackSpeed, 0, rows);
}

double HingeJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    if (axis != JointAxis::AngularX) return JointType::Coordinate(axis, pose);
    return turns_.After(AngleAbout(pose, 0), pose.TurnedAbout(AxisAbout(pose, 0)));
}

JointDrawing HingeJoint::Drawing() const { return {.rotations = true}; }

}  // namespace fulcrum
