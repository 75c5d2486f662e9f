#include <Fulcrum/Constraints/Joints/HingeJoint.h>

#include <algorithm>

namespace fulcrum {

namespace {

float AngleOf(const JointPose& pose) { return TwistAngle(pose.frameA.Conjugate() * pose.frameB); }

}  // namespace

void HingeJoint::Start(const JointPose& pose) {
    const double angle = AngleOf(pose);
    turns_.Set(angle);
    if (!control_.limited) return;
    // Of the turns next to the interval, the one that is farthest inside.
    const double min = control_.limits.min, max = control_.limits.max;
    const auto outside = [&](double x) { return std::max(min - x, x - max); };
    for (const double end : {min, max}) {
        if (!std::isfinite(end)) continue;
        for (const double near : {end, end - kFullTurn, end + kFullTurn}) {
            const double candidate = NearestTurn(angle, near);
            if (outside(candidate) < std::max(outside(turns_.Angle()), 0.0)) turns_.Set(candidate);
        }
    }
}

void HingeJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    JointRow motion;
    pose.SetAbout(motion, TwistAxis(ToMatrix(pose.frameA), ToMatrix(pose.frameB)));
    turns_.Advance(AngleOf(pose), pose.SpeedOf(motion), pose.dt);
    AddControlRows(control_, pose, motion, turns_.Angle(), kAngularSlackSpeed, 0, rows);
}

double HingeJoint::Coordinate(JointAxis axis, const JointPose& pose) const {
    if (axis != JointAxis::AngularX) return JointType::Coordinate(axis, pose);
    return NearestTurn(AngleOf(pose), turns_.Angle());
}

}  // namespace fulcrum
