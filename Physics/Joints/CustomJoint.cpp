#include <Fulcrum/Physics/Joints/CustomJoint.h>

#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const CustomJointSettings& s) {
    if (MaybeError e = CheckCommon(s)) return e;
    if (s.make) return std::nullopt;
    return Error{ErrorCode::Unsupported, "make is empty; the joint needs a type"};
}

std::unique_ptr<JointType> MakeType(const CustomJointSettings& s) { return s.make(); }

}  // namespace fulcrum
