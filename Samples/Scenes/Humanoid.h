// The ragdoll that the scenes share: twelve capsules, about 1.8 m tall, pelvis at the origin, arms hanging down, facing +z. The
// file Ragdoll/humanoid.json describes the same one. Free functions, any thread.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

// In the order of the parts.
enum class HumanoidPart : size_t {
    Pelvis, Torso, Head, UpperArmLeft, UpperArmRight, LowerArmLeft, LowerArmRight,
    UpperLegLeft, UpperLegRight, LowerLegLeft, LowerLegRight, FootLeft,
};

// Density 1000 kg/m3, no motors.
RagdollSettings Humanoid();

// With position motors on all joints, of the spring frequency in Hz, critically damped, of at most `maxTorque` N m.
RagdollSettings HumanoidWithMotors(float frequency, float maxTorque);

}  // namespace fulcrum
