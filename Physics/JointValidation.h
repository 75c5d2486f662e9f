// Checks of what callers pass in as settings of a joint, and the joint types made of them. Each check returns an error
// that names the field, its value and what would be valid; bodies are checked where they are known. Called when a joint
// is created. Free functions, no threads.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/Validation.h>

#include <memory>

namespace fulcrum {

// A field, or a part of one, as an error names it. Put together only where there is an error: settings are checked in
// every step that drives a motor. What it is made of must outlive it.
class FieldName {
public:
    FieldName(const char* name) : name_(name) {}
    FieldName(const FieldName& whole, const char* part) : whole_(&whole), name_(part) {}
    std::string Text() const { return whole_ ? whole_->Text() + name_ : name_; }

private:
    const FieldName* whole_ = nullptr;
    const char* name_;
};

// Of an anchor's frame, X along its axis, in the space that it is given in.
Quaternion RotationOf(const JointAnchor& anchor);

// What all joints share.
MaybeError CheckCommon(const JointSettings& settings);
// Of an axis; limits may be infinite where the bounds are. Allocates nothing where nothing is wrong.
MaybeError CheckControl(const FieldName& name, const AxisControl& control, const LimitBounds& bounds = {});

MaybeError CheckMassOverride(const FieldName& name, const MassOverride& massOverride);

// The fields of a kind, and those that all joints share.
MaybeError Check(const PointJointSettings& settings);
MaybeError Check(const FixedJointSettings& settings);
MaybeError Check(const DistanceJointSettings& settings);
MaybeError Check(const HingeJointSettings& settings);
MaybeError Check(const SliderJointSettings& settings);
MaybeError Check(const ConeJointSettings& settings);
MaybeError Check(const SwingTwistJointSettings& settings);
MaybeError Check(const SixDofJointSettings& settings);
MaybeError Check(const GearJointSettings& settings);
MaybeError Check(const RackAndPinionJointSettings& settings);
MaybeError Check(const PulleyJointSettings& settings);
MaybeError Check(const PathJointSettings& settings);
MaybeError Check(const WheelJointSettings& settings);
MaybeError Check(const CustomJointSettings& settings);

// Settings must have passed their check. Null where a custom `make` gives null.
std::unique_ptr<JointType> MakeType(const PointJointSettings& settings);
std::unique_ptr<JointType> MakeType(const FixedJointSettings& settings);
std::unique_ptr<JointType> MakeType(const DistanceJointSettings& settings);
std::unique_ptr<JointType> MakeType(const HingeJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SliderJointSettings& settings);
std::unique_ptr<JointType> MakeType(const ConeJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SwingTwistJointSettings& settings);
std::unique_ptr<JointType> MakeType(const SixDofJointSettings& settings);
std::unique_ptr<JointType> MakeType(const GearJointSettings& settings);
std::unique_ptr<JointType> MakeType(const RackAndPinionJointSettings& settings);
std::unique_ptr<JointType> MakeType(const PulleyJointSettings& settings);
std::unique_ptr<JointType> MakeType(const PathJointSettings& settings);
std::unique_ptr<JointType> MakeType(const WheelJointSettings& settings);
std::unique_ptr<JointType> MakeType(const CustomJointSettings& settings);

}  // namespace fulcrum
