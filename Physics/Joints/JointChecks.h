// Checks of settings shared by the kinds of joints. Each returns an error with the field's name, its value and the
// valid range. Called when a joint is created or changed. Free functions.
#pragma once

#include <Fulcrum/Constraints/Joints/AngularControls.h>
#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/Validation.h>

#include <memory>

namespace fulcrum {

// The name of a field, or of a part of one, in error messages. Concatenated only if there is an error, because driving
// a motor checks its settings in every step. The strings must outlive it.
class FieldName {
public:
    FieldName(const char* name) : name_(name) {}
    FieldName(const FieldName& whole, const char* part) : whole_(&whole), name_(part) {}
    std::string Text() const { return whole_ ? whole_->Text() + name_ : name_; }

private:
    const FieldName* whole_ = nullptr;
    const char* name_;
};

// The two bodies of a joint. motionOf(id): none if no body has the id.
MaybeError CheckJointBodies(const JointSettings& settings, FunctionRef<std::optional<MotionType>(BodyId)> motionOf);

// The type of a joint whose settings have passed their Check. Errors: those of CheckJointBodies; Unsupported (the
// function of a custom joint gave no type).
template <class Settings>
Result<std::unique_ptr<JointType>> MakeCheckedType(const Settings& settings,
                                                   FunctionRef<std::optional<MotionType>(BodyId)> motionOf) {
    if (MaybeError error = CheckJointBodies(settings, motionOf)) return *error;
    std::unique_ptr<JointType> type = MakeType(settings);
    if (!type) return Error{ErrorCode::Unsupported, "make: gave no joint type"};
    return type;
}

// Rotation of an anchor's frame, x along its axis, in the space in which it is given.
Quaternion RotationOf(const JointAnchor& anchor);
// Sets the normal to the direction nearest to `wanted` that is perpendicular to the axis; not where it is along the
// axis.
void SetNormalNear(JointAnchor& anchor, const Vector3& wanted);

// Checks that x is within `low`..`high`, which may be infinite.
MaybeError CheckBetween(const FieldName& field, double x, double low, double high);
MaybeError CheckOrder(const FieldName& lowField, double low, const FieldName& highField, double high);
MaybeError CheckSpring(const FieldName& name, const SpringSettings& spring);
// A ratio of gears etc., of either sign. Bounded so that its product with the largest lengths, and its inverse, fit a
// float.
MaybeError CheckRatio(const FieldName& field, float x);

// The settings shared by all joints.
MaybeError CheckCommon(const JointSettings& settings);
// Settings of an axis; limits may be infinite if the bounds are. Allocates nothing unless there is an error.
MaybeError CheckControl(const FieldName& name, const AxisControl& control, const LimitBounds& bounds = {});

// Rotation axes limited as swing and twist.
MaybeError CheckSwingTwist(const std::array<const char*, 3>& names, const std::array<AxisControl, 3>& axes,
                           SwingShape shape);
MaybeError CheckMassOverride(const FieldName& name, const MassOverride& massOverride);

// The fields of a kind together with the shared ones.
template <class... Checks>
MaybeError CheckWith(const JointSettings& settings, Checks&&... checks) {
    return FirstOf(CheckCommon(settings), std::forward<Checks>(checks)...);
}

}  // namespace fulcrum
