// The ragdoll that the scenes share: twelve capsules, about 1.8 m tall, pelvis at the origin, arms hanging down, facing
// +z. The file Ragdoll/humanoid.json describes the same one. Free functions, any thread.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

#include <array>

namespace fulcrum {

// In the order of the parts.
enum class HumanoidPart : size_t {
    Pelvis,
    Torso,
    Head,
    UpperArmLeft,
    UpperArmRight,
    LowerArmLeft,
    LowerArmRight,
    UpperLegLeft,
    UpperLegRight,
    LowerLegLeft,
    LowerLegRight,
    FootLeft,
};

// Density 1000 kg/m3, no motors.
RagdollSettings Humanoid();

// With position motors on all joints: N m/rad, N m s/rad, at most N m.
RagdollSettings HumanoidWithMotors(float stiffness, float damping, float maxTorque);

// The joint rotations of three poses that all limits allow, for PoseFromJoints, at a time in 0 .. 3: pose k, from 0, is
// taken up from k to k + 0.4 and held until k + 1; before the first it stands with its arms down.
inline constexpr double kHumanoidPoses = 3;
std::array<Quaternion, 12> HumanoidMotion(double time);

}  // namespace fulcrum
