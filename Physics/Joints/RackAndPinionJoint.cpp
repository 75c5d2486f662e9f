#include <Fulcrum/Physics/Joints/RackAndPinionJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Constraints/Parts/RackAndPinionPart.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <cmath>

namespace fulcrum {

MaybeError Check(const RackAndPinionJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }

std::unique_ptr<JointType> MakeType(const RackAndPinionJointSettings& s) {
    return std::make_unique<RackAndPinionJoint>(s.ratio);
}

BearingAngle RackAndPinionJoint::Pinion() { return BearingAngle(std::span(state_).first<BearingAngle::kNumbers>()); }

void RackAndPinionJoint::Start(const JointPose& pose) {
    Pinion().Start(pose.frameA);
    state_[BearingAngle::kNumbers] = Dot(pose.offset, ToMatrix(pose.frameB).x);
}

void RackAndPinionJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const Vector3 axis = ToMatrix(pose.frameA).x, way = ToMatrix(pose.frameB).x;
    const double angle = Pinion().Advance(pose.frameA, Dot(axis, pose.turnedA));
    const double moved = Dot(pose.offset, way) - state_[BearingAngle::kNumbers];
    JointRow& row = rows.Add(0, JointRow::Kind::Equal);
    row.jacobian = RackAndPinionJacobian<float>({pose.armA, pose.armB - pose.offset, axis, way, ratio_});
    row.inRadians = true;
    row.error = static_cast<float>(angle - static_cast<double>(ratio_) * moved);
}

JointDrawing RackAndPinionJoint::Drawing() const { return {.trackB = 0, .circleA = 1.0f / std::fabs(ratio_)}; }

}  // namespace fulcrum
