#include <Fulcrum/Physics/Joints/FixedJoint.h>

#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const FixedJointSettings& s) { return CheckCommon(s); }

std::unique_ptr<JointType> MakeType(const FixedJointSettings&) { return std::make_unique<FixedJoint>(); }

}  // namespace fulcrum
