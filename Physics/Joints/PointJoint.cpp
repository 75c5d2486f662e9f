#include <Fulcrum/Physics/Joints/PointJoint.h>

#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const PointJointSettings& s) { return CheckCommon(s); }

std::unique_ptr<JointType> MakeType(const PointJointSettings&) { return std::make_unique<PointJoint>(); }

}  // namespace fulcrum
