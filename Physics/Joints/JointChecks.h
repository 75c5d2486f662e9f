// Checks that the kinds of joints share. Each returns an error that names the field, its value and what would be valid;
// bodies are checked where they are known. Called when a joint is created or changed. Free functions, no threads.
#pragma once

#include <Fulcrum/Constraints/Joints/AngularControls.h>
#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/Validation.h>

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

// From `low` to `high`, which may be infinite.
MaybeError CheckBetween(const FieldName& field, double x, double low, double high);
MaybeError CheckOrder(const FieldName& lowField, double low, const FieldName& highField, double high);
MaybeError CheckSpring(const FieldName& name, const SpringSettings& spring);
// A ratio of gears and the like, of either sign. Times the largest lengths it is still a float, and so is its inverse.
MaybeError CheckRatio(const FieldName& field, float x);

// What all joints share.
MaybeError CheckCommon(const JointSettings& settings);
// Of an axis; limits may be infinite where the bounds are. Allocates nothing where nothing is wrong.
MaybeError CheckControl(const FieldName& name, const AxisControl& control, const LimitBounds& bounds = {});

// Rotations limited as swing and twist.
MaybeError CheckSwingTwist(const std::array<const char*, 3>& names, const std::array<AxisControl, 3>& axes,
                           SwingShape shape);
MaybeError CheckMassOverride(const FieldName& name, const MassOverride& massOverride);

// Both a kind's own fields and the shared ones.
template <class... Checks>
MaybeError CheckWith(const JointSettings& settings, Checks&&... checks) {
    return FirstOf(CheckCommon(settings), std::forward<Checks>(checks)...);
}

}  // namespace fulcrum
