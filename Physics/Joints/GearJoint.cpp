#include <Fulcrum/Physics/Joints/GearJoint.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

MaybeError Check(const GearJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }

std::unique_ptr<JointType> MakeType(const GearJointSettings& s) { return std::make_unique<GearJoint>(s.ratio); }

// Pitch circles that meet between the axles; their radii are as the numbers of teeth.
JointDrawing GearJoint::Drawing() const {
    constexpr float kLeast = 1e-3f;  // m
    const float sum = ratio_ > 0.0f ? 1.0f + ratio_ : std::fabs(1.0f + ratio_);
    const float radius = sum > kLeast ? distance_ / sum : 0.0f;
    if (radius <= kLeast) return {.circleA = 0.0f, .circleB = 0.0f};
    return {.circleA = radius, .circleB = std::fabs(ratio_) * radius};
}

}  // namespace fulcrum
