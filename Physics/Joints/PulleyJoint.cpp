#include <Fulcrum/Physics/Joints/PulleyJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Constraints/Parts/IndependentAxisPart.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <algorithm>

namespace fulcrum {

MaybeError Check(const PulleyJointSettings& s) {
    if (MaybeError e = CheckWith(s, CheckPosition("fixedPointA", s.fixedPointA),
                                 CheckPosition("fixedPointB", s.fixedPointB), CheckPositive("ratio", s.ratio),
                                 CheckRatio("ratio", s.ratio), CheckNotNegative("minLength", s.minLength)))
        return e;
    if (!s.maxLength) return std::nullopt;
    return FirstOf(CheckBetween("maxLength", *s.maxLength, 0.0, LimitBounds::kEndless),
                   CheckOrder("minLength", s.minLength, "maxLength", *s.maxLength));
}

std::unique_ptr<JointType> MakeType(const PulleyJointSettings& s) {
    return std::make_unique<PulleyJoint>(s.fixedPointA, s.fixedPointB, s.ratio, s.minLength, s.maxLength);
}

PulleyJoint::PulleyJoint(const Position& fixedPointA, const Position& fixedPointB, float ratio, float minLength,
                         std::optional<float> maxLength)
    : LengthJointType({minLength, maxLength.value_or(minLength), {}}, !maxLength),
      fixedPointA_(fixedPointA),
      fixedPointB_(fixedPointB),
      ratio_(ratio) {}

std::pair<Vector3, Vector3> PulleyJoint::RopesAt(const JointPose& pose) const {
    return {(pose.anchorA - fixedPointA_).cast<float>(),
            (pose.anchorA + pose.offset.cast<double>() - fixedPointB_).cast<float>()};
}

void PulleyJoint::Start(const JointPose& pose) {
    if (isMeasured_) control_.limits.max = std::max(LengthAt(pose), control_.limits.min);
}

void PulleyJoint::CollectRows(const JointPose& pose, JointRowList& rows) {
    const auto [ropeA, ropeB] = RopesAt(pose);
    const float lengthA = Length(ropeA), lengthB = Length(ropeB), length = lengthA + ratio_ * lengthB;
    Vector3 axisA = Normalized(ropeA, Vector3::Zero()), axisB = Normalized(ropeB, Vector3::Zero()) * ratio_;
    // A side shorter than the excess length cannot shorten further and would oscillate: only the other side acts.
    constexpr float kShort = 0.5f;  // m
    const float givesNothing = std::min(length - control_.limits.max, kShort);
    if (lengthA < givesNothing && lengthA <= ratio_ * lengthB) axisA = Vector3::Zero();
    else if (ratio_ * lengthB < givesNothing) axisB = Vector3::Zero();
    JointRow motion;
    motion.jacobian = IndependentAxisJacobian<float>({pose.armA, pose.armB, axisA, axisB});
    // Each side may swing independently.
    const auto stretch = [&](const Twist<float>& velocity, const Vector3& arm, float rope) {
        return StretchSpeed(rope, Length(Vector3(velocity.linear + Cross(velocity.angular, arm))), pose.dt);
    };
    const float slack =
        stretch(pose.velocityA, pose.armA, lengthA) + ratio_ * stretch(pose.velocityB, pose.armB, lengthB);
    AddControlRows(control_, pose, motion, length, kLinearSlackSpeed + slack, 0, rows);
}

float PulleyJoint::LengthAt(const JointPose& pose) const {
    const auto [ropeA, ropeB] = RopesAt(pose);
    return Length(ropeA) + ratio_ * Length(ropeB);
}

JointDrawing PulleyJoint::Drawing() const {
    return {.isRope = true, .ropeRatio = ratio_, .ropePoints = {fixedPointA_, fixedPointB_}};
}

}  // namespace fulcrum
