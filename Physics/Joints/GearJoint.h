// Gear joint: A and B rotate about the x axes of their frames and mesh. Other joints must hold their bearings.
//
//   theta1, theta2  rotation of A and of B about their axes since the joint was created
//   ratio           revolutions of A per revolution of B
//   Rows:           the gear part's, C = theta1 + ratio theta2
// Both angles are counted over any number of revolutions without drift (BearingAngle.h).
#pragma once

#include <Fulcrum/Constraints/Joints/BearingAngle.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A rotates about anchor A's axis, B about anchor B's; their teeth mesh. Each needs a bearing, such as a hinge to a
// body at rest. Revolutions of A = -ratio * revolutions of B.
struct GearJointSettings : JointSettings {
    float ratio = 1.0f;  // |ratio| in 1e-9..1e9; teeth of B / teeth of A, > 0 for external gears
};
MaybeError Check(const GearJointSettings& settings);
std::unique_ptr<JointType> MakeType(const GearJointSettings& settings);

class GearJoint final : public JointType {
public:
    // ratio: not zero; > 0 for external gears, which rotate in opposite directions.
    explicit GearJoint(float ratio) : ratio_(ratio) {}

    const char* Kind() const override { return "gear"; }
    bool ReactsOnWorld() const override { return true; }
    JointDrawing Drawing() const override;
    uint32_t MaxRows() const override { return 1; }
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    std::span<double> State() override { return state_; }
    void VisitSettings(const SettingVisitor& visit) override {
        visit(ratio_);
        visit(distance_);
    }

private:
    static constexpr size_t kNumbers = BearingAngle::kNumbers;
    BearingAngle OfA();
    BearingAngle OfB();

    float ratio_;
    float distance_ = 0;  // m, between the anchors when the joint was created
    std::array<double, 2 * kNumbers> state_{};
};

}  // namespace fulcrum
