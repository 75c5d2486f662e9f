// Ball joint: B's anchor stays at A's, and B rotates freely. Locks only.
//   Locks:      point
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// B's anchor stays at A's; B rotates freely.
struct PointJointSettings : JointSettings {};
MaybeError Check(const PointJointSettings& settings);
std::unique_ptr<JointType> MakeType(const PointJointSettings& settings);

class PointJoint final : public JointType {
public:
    const char* Kind() const override { return "point"; }
    JointLocks Locks() const override { return {.linear = LinearLock::Point}; }
};

}  // namespace fulcrum
