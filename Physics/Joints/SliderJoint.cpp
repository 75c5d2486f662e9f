#include <Fulcrum/Physics/Joints/SliderJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const SliderJointSettings& s) { return CheckWith(s, CheckControl("slide", s.slide)); }

std::unique_ptr<JointType> MakeType(const SliderJointSettings& s) { return std::make_unique<SliderJoint>(s.slide); }

JointDrawing SliderJoint::Drawing() const { return {.trackA = 0}; }

}  // namespace fulcrum
