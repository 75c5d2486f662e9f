// Distance joint (rod, rope or spring): the distance of the two anchors stays in a range.
//
//   u = p2 - p1, d = |u|, n = u / d
//   Rows:       C = d - ..., J = [-n, -r1 x n, n, r2 x n] (LinearX)
// If the anchors coincide, n is x of frame A.
#pragma once

#include <Fulcrum/Constraints/Joints/LengthJointType.h>
#include <Fulcrum/Physics/JointSettings.h>

#include <optional>

namespace fulcrum {

// The distance of the anchors stays in a range: a rod, a rope, a spring.
struct DistanceJointSettings : JointSettings {
    // m, 0 <= min <= max, max may be infinite. If one is left out: 0 or infinity. If both are left out: the distance
    // when the joint is created.
    std::optional<float> minDistance{}, maxDistance{};
    SpringSettings spring{};  // of both limits; if min is max, of the distance itself
};
MaybeError Check(const DistanceJointSettings& settings);
std::unique_ptr<JointType> MakeType(const DistanceJointSettings& settings);

class DistanceJoint final : public LengthJointType {
public:
    // m, 0 <= min <= max. If one is left out: 0 or infinity; if both: a rod as long as the distance when the joint is
    // created. The spring is that of both limits.
    DistanceJoint(std::optional<float> minDistance, std::optional<float> maxDistance, const SpringSettings& spring);

    const char* Kind() const override { return "distance"; }
    JointDrawing Drawing() const override;
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;

private:
    float LengthAt(const JointPose& pose) const override { return Length(pose.offset); }
};

}  // namespace fulcrum
