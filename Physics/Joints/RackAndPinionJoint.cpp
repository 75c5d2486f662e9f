#include <Fulcrum/Physics/Joints/RackAndPinionJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const RackAndPinionJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }

std::unique_ptr<JointType> MakeType(const RackAndPinionJointSettings& s) {
    return std::make_unique<RackAndPinionJoint>(s.ratio);
}

JointDrawing RackAndPinionJoint::Drawing() const { return {.trackB = 0, .circleA = 1.0f / std::fabs(ratio_)}; }

}  // namespace fulcrum
