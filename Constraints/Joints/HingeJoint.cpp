#include <Fulcrum/Constraints/Joints/HingeJoint.h>

namespace fulcrum {

void HingeJoint::Start(const JointPose& pose) { turns_.Start(AngleAbout(pose, 0), control_); }

void HingeJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    JointRow motion;
    pose.SetAbout(motion, AxisAbout(pose, 0));
    turns_.Advance(AngleAbout(pose, 0), pose.SpeedOf(motion), pose.dt);
    AddControlRows(control_, pose, motion, turns_.Angle(), kAngularSlackSpeed, 0, rows);
}

double HingeJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    return axis == JointAxis::AngularX ? NearestTurn(AngleAbout(pose, 0), turns_.Angle()) : JointType::Coordinate(axis, pose);
}

}  // namespace fulcrum
