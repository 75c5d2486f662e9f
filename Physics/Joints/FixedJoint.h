// Fixed joint: B does not move relative to A. Locks only.
//   Locks:      point; all rotation
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// B does not move relative to A.
struct FixedJointSettings : JointSettings {};
MaybeError Check(const FixedJointSettings& settings);
std::unique_ptr<JointType> MakeType(const FixedJointSettings& settings);

class FixedJoint final : public JointType {
public:
    const char* Kind() const override { return "fixed"; }
    JointLocks Locks() const override { return {.linear = LinearLock::Point, .angular = AngularLock::All}; }
};

}  // namespace fulcrum
