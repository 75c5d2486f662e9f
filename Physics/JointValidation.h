// Checks of what callers pass in as settings of a joint, and the joint types made of them. Each check returns an error that
// names the field, its value and what would be valid; bodies are checked where they are known. Called when a joint is
// created. Free functions, no threads.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/Validation.h>

#include <memory>

namespace fulcrum {

// What all joints share.
MaybeError CheckCommon(const JointSettings& settings);
// Of an axis named `name`; limits may be infinite.
MaybeError CheckControl(const std::string& name, const AxisControl& control);

// The fields of a kind, and those that all joints share.
MaybeError Check(const PointJointSettings& settings);
MaybeError Check(const FixedJointSettings& settings);
MaybeError Check(const DistanceJointSettings& settings);
MaybeError Check(const HingeJointSettings& settings);
MaybeError Check(const SliderJointSettings& settings);

// Settings must have passed their check.
std::unique_ptr<JointType> MakeType(const PointJointSettings& settings);
std::unique_ptr<JointType> MakeType(const FixedJointSettings& settings);
std::unique_ptr<JointType> MakeType(const DistanceJointSettings& settings);
std::unique_ptr<JointType> MakeType(const HingeJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SliderJointSettings& settings);

}  // namespace fulcrum
