// A joint whose type the user derives from JointType.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// A user-defined constraint.
struct CustomJointSettings : JointSettings {
    Function<std::unique_ptr<JointType>()> make;  // not empty; called once per joint, creates its type
};
MaybeError Check(const CustomJointSettings& settings);
std::unique_ptr<JointType> MakeType(const CustomJointSettings& settings);

}  // namespace fulcrum
