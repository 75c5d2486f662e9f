#include <Fulcrum/Physics/Joints/GearJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Constraints/Parts/GearPart.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <cmath>

namespace fulcrum {

MaybeError Check(const GearJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }

std::unique_ptr<JointType> MakeType(const GearJointSettings& s) { return std::make_unique<GearJoint>(s.ratio); }

BearingAngle GearJoint::OfA() { return BearingAngle(std::span(state_).first<kNumbers>()); }
BearingAngle GearJoint::OfB() { return BearingAngle(std::span(state_).last<kNumbers>()); }

void GearJoint::Start(const JointPose& pose) {
    OfA().Start(pose.frameA);
    OfB().Start(pose.frameB);
    distance_ = Length(pose.offset);
}

void GearJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const Vector3 axisA = ToMatrix(pose.frameA).x, axisB = ToMatrix(pose.frameB).x;
    const double angleA = OfA().Advance(pose.frameA, Dot(axisA, pose.turnedA));
    const double angleB = OfB().Advance(pose.frameB, Dot(axisB, pose.turnedB));
    JointRow& row = rows.Add(0, JointRow::Kind::Equal);
    row.jacobian = GearJacobian<float>(axisA, axisB, ratio_);
    row.error = static_cast<float>(angleA + static_cast<double>(ratio_) * angleB);
}

// Pitch circles that touch between the axles; the ratio of their radii is that of the numbers of teeth.
JointDrawing GearJoint::Drawing() const {
    constexpr float kLeast = 1e-3f;  // m
    const float sum = ratio_ > 0.0f ? 1.0f + ratio_ : std::fabs(1.0f + ratio_);
    const float radius = sum > kLeast ? distance_ / sum : 0.0f;
    if (radius <= kLeast) return {.circleA = 0.0f, .circleB = 0.0f};
    return {.circleA = radius, .circleB = std::fabs(ratio_) * radius};
}

}  // namespace fulcrum
