#include <Fulcrum/Physics/Joints/SwingTwistJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const SwingTwistJointSettings& s) {
    return CheckWith(s, CheckSwingTwist({"twist", "swingY", "swingZ"}, {s.twist, s.swingY, s.swingZ}, s.shape));
}

std::unique_ptr<JointType> MakeType(const SwingTwistJointSettings& s) {
    return std::make_unique<SwingTwistJoint>(s.twist, s.swingY, s.swingZ, s.shape);
}

JointDrawing SwingTwistJoint::Drawing() const {
    return {.rotations = true, .isPyramid = angular_.Shape() == SwingShape::Pyramid};
}

}  // namespace fulcrum
