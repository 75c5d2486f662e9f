// A joint of a type that the user derives from JointType; no threads.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A constraint of the user's own.
struct CustomJointSettings : JointSettings {
    Function<std::unique_ptr<JointType>()> make;  // not empty; called once a joint, gives a type
};
MaybeError Check(const CustomJointSettings& settings);
std::unique_ptr<JointType> MakeType(const CustomJointSettings& settings);

}  // namespace fulcrum
