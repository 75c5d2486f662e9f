// Pulley joint: a rope from A over two fixed points of the world to B, with a mechanical advantage (block and tackle)
// of `ratio` on B's side.
//
//   p1, p2  anchors of A and B      f1, f2  fixed points      n1 = (p1 - f1) / |p1 - f1|, n2 likewise
//   l = |p1 - f1| + ratio |p2 - f2|, in minLength .. maxLength (LinearX)
//   Rows:       C = l - minLength >= 0, maxLength - l >= 0,  l' = n1 . (v1 + w1 x r1) + ratio n2 . (v2 + w2 x r2)
// A side of length zero has no direction and exerts no force.
#pragma once

#include <Fulcrum/Constraints/Joints/LengthJointType.h>
#include <Fulcrum/Physics/JointSettings.h>

#include <optional>

namespace fulcrum {

// A rope from A's anchor over two fixed points to B's: distance of A + ratio distance of B = its length.
struct PulleyJointSettings : JointSettings {
    Position fixedPointA = Position::Zero();  // m, world space
    Position fixedPointB = Position::Zero();  // m, world space
    float ratio = 1.0f;                       // 1e-9..1e9
    float minLength = 0.0f;                   // m, >= 0
    std::optional<float> maxLength{};         // m, >= minLength; left out: the length when the joint is created
};
MaybeError Check(const PulleyJointSettings& settings);
std::unique_ptr<JointType> MakeType(const PulleyJointSettings& settings);

class PulleyJoint final : public LengthJointType {
public:
    // m, world space. ratio > 0; 0 <= minLength <= maxLength; if left out, maxLength is the length when the joint is
    // created.
    PulleyJoint(const Position& fixedPointA, const Position& fixedPointB, float ratio, float minLength,
                std::optional<float> maxLength);

    const char* Kind() const override { return "pulley"; }
    bool ReactsOnWorld() const override { return true; }
    JointDrawing Drawing() const override;
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void VisitSettings(const SettingVisitor& visit) override {
        visit(fixedPointA_);
        visit(fixedPointB_);
        visit(ratio_);
        LengthJointType::VisitSettings(visit);
    }

private:
    float LengthAt(const JointPose& pose) const override;
    // From the fixed points to the anchors of A and of B, m.
    std::pair<Vector3, Vector3> RopesAt(const JointPose& pose) const;

    Position fixedPointA_, fixedPointB_;
    float ratio_;
};

}  // namespace fulcrum
