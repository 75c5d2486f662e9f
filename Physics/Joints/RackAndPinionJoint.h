// Rack and pinion: the pinion, A, rotates about the x axis of its frame; the rack, B, moves along the x axis of its
// own. Other joints must hold the pinion's bearing and the rack's guide.
//
//   theta  rotation of the pinion about its axis since the joint was created        ratio  rad of theta per meter of d
//   d      distance of the rack's anchor from the pinion's along the rack's axis
//   Rows:       the rack-and-pinion part's, C = theta - ratio (d - d0)
#pragma once

#include <Fulcrum/Constraints/Joints/BearingAngle.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A, the pinion, rotates about anchor A's axis through its point; B, the rack, moves along anchor B's axis. Other
// joints must hold the bearing and the guide.
struct RackAndPinionJointSettings : JointSettings {
    float ratio = 1.0f;  // rad/m, |ratio| in 1e-9..1e9; 1 / radius of the pinion, < 0 to reverse
};
MaybeError Check(const RackAndPinionJointSettings& settings);
std::unique_ptr<JointType> MakeType(const RackAndPinionJointSettings& settings);

class RackAndPinionJoint final : public JointType {
public:
    explicit RackAndPinionJoint(float ratio) : ratio_(ratio) {}  // rad/m, not zero

    const char* Kind() const override { return "rack and pinion"; }
    bool ReactsOnWorld() const override { return true; }
    JointDrawing Drawing() const override;
    uint32_t MaxRows() const override { return 1; }
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    std::span<double> State() override { return state_; }
    void VisitSettings(const SettingVisitor& visit) override { visit(ratio_); }

private:
    BearingAngle Pinion();

    float ratio_;
    std::array<double, BearingAngle::kNumbers + 1> state_{};
};

}  // namespace fulcrum
