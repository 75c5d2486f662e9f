#include <Fulcrum/Physics/Joints/DistanceJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const DistanceJointSettings& s) {
    const double min = s.minDistance.value_or(0.0f), max = s.maxDistance ? *s.maxDistance : LimitBounds::kEndless;
    return CheckWith(s, CheckNotNegative("minDistance", min),
                     CheckBetween("maxDistance", max, 0.0, LimitBounds::kEndless),
                     CheckOrder("minDistance", min, "maxDistance", max), CheckSpring("spring", s.spring));
}

std::unique_ptr<JointType> MakeType(const DistanceJointSettings& s) {
    return std::make_unique<DistanceJoint>(s.minDistance, s.maxDistance, s.spring);
}

DistanceJoint::DistanceJoint(std::optional<float> minDistance, std::optional<float> maxDistance,
                             const SpringSettings& spring)
    : LengthJointType(
          {minDistance.value_or(0.0f), maxDistance.value_or(std::numeric_limits<float>::infinity()), spring},
          !minDistance && !maxDistance) {}

void DistanceJoint::Start(const JointPose& pose) {
    if (isMeasured_) control_.limits.min = control_.limits.max = Length(pose.offset);
}

void DistanceJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const float distance = Length(pose.offset);
    JointRow motion;
    pose.SetAlong(motion, Normalized(pose.offset, ToMatrix(pose.frameA).x));
    motion.radial = true;
    motion.turnsWithA = false;
    const float slack = kLinearSlackSpeed + StretchSpeed(distance, Length(pose.AnchorVelocity()), pose.dt);
    AddControlRows(control_, pose, motion, distance, slack, 0, rows);
}

JointDrawing DistanceJoint::Drawing() const { return {.isRope = true}; }

}  // namespace fulcrum
