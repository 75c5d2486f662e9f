#include <Fulcrum/Physics/JointValidation.h>

#include <Fulcrum/Constraints/Joints/ConeJoint.h>
#include <Fulcrum/Constraints/Joints/DistanceJoint.h>
#include <Fulcrum/Constraints/Joints/GearJoint.h>
#include <Fulcrum/Constraints/Joints/HingeJoint.h>
#include <Fulcrum/Constraints/Joints/LockJoint.h>
#include <Fulcrum/Constraints/Joints/PathJoint.h>
#include <Fulcrum/Constraints/Joints/PulleyJoint.h>
#include <Fulcrum/Constraints/Joints/RackAndPinionJoint.h>
#include <Fulcrum/Constraints/Joints/SixDofJoint.h>
#include <Fulcrum/Constraints/Joints/SliderJoint.h>
#include <Fulcrum/Constraints/Joints/SwingTwistJoint.h>
#include <Fulcrum/Constraints/Joints/WheelJoint.h>

#include <cstdio>

namespace fulcrum {

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kHalfTurn = 3.1415927410125732;  // pi as a float

std::string Number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

MaybeError CheckNotNaN(const FieldName& field, double x) {
    if (x == x) return std::nullopt;
    return Error{ErrorCode::NonFinite, field.Text() + " is NaN; it must be a number"};
}

MaybeError CheckFiniteField(const FieldName& field, double x) {
    if (std::isfinite(x)) return std::nullopt;
    return Error{ErrorCode::NonFinite, field.Text() + " is " + Number(x) + "; it must be finite"};
}

// From `low` to `high`, which may be infinite.
MaybeError CheckBetween(const FieldName& field, double x, double low, double high) {
    if (MaybeError e = CheckNotNaN(field, x)) return e;
    if (x >= low && x <= high) return std::nullopt;
    return Error{ErrorCode::OutOfRange,
                 field.Text() + " is " + Number(x) + "; it must be from " + Number(low) + " to " + Number(high)};
}

MaybeError CheckOrder(const FieldName& lowField, double low, const FieldName& highField, double high) {
    if (low <= high) return std::nullopt;
    return Error{ErrorCode::OutOfRange, lowField.Text() + " is " + Number(low) + "; it must not be larger than " +
                                            highField.Text() + ", which is " + Number(high)};
}

MaybeError CheckUnit(const FieldName& field, const Vector3& v) {
    if (MaybeError e = fulcrum::CheckFinite(field.Text().c_str(), v)) return e;
    const double length = std::sqrt(v.cast<double>().squaredNorm());
    if (std::fabs(length - 1.0) <= 1e-3) return std::nullopt;
    return Error{ErrorCode::Unnormalized, field.Text() + " has length " + Number(length) + "; it must be 1"};
}

MaybeError CheckAnchor(const FieldName& name, const JointAnchor& anchor) {
    if (MaybeError e = FirstOf(CheckPosition(FieldName(name, ".point").Text().c_str(), anchor.point),
                               CheckUnit({name, ".axis"}, anchor.axis)))
        return e;
    if (!anchor.normal) return std::nullopt;
    if (MaybeError e = CheckUnit({name, ".normal"}, *anchor.normal)) return e;
    const float cosine = Dot(anchor.axis, *anchor.normal);
    if (std::fabs(cosine) <= 1e-3f) return std::nullopt;
    return Error{ErrorCode::Degenerate, name.Text() + ".normal is not perpendicular to " + name.Text() +
                                            ".axis: their cosine is " + Number(cosine) + "; it must be 0 within 0.001"};
}

MaybeError CheckBreak(const char* field, float x) {
    if (MaybeError e = CheckNotNaN(field, x)) return e;
    if (x > 0.0f) return std::nullopt;
    return Error{ErrorCode::NonPositive, std::string(field) + " is " + Number(x) + "; it must be larger than 0"};
}

MaybeError CheckSpring(const FieldName& name, const SpringSettings& spring) {
    const Status status = Validate(spring);
    if (status) return std::nullopt;
    // Its messages begin with "spring ".
    return Error{status.GetError().code, name.Text() + "." + status.GetError().message.substr(7)};
}

template <class E>
MaybeError CheckEnum(const FieldName& field, E value, E last) {
    if (static_cast<int>(value) <= static_cast<int>(last)) return std::nullopt;
    return Error{ErrorCode::OutOfRange, field.Text() + " is " + Number(static_cast<int>(value)) +
                                            "; it must be from 0 to " + Number(static_cast<int>(last))};
}

MaybeError CheckLimits(const FieldName& name, const JointLimits& limits) {
    if (MaybeError e = FirstOf(CheckNotNaN({name, ".min"}, limits.min), CheckNotNaN({name, ".max"}, limits.max),
                               CheckOrder({name, ".min"}, limits.min, {name, ".max"}, limits.max),
                               CheckSpring({name, ".spring"}, limits.spring)))
        return e;
    if (limits.min < kEndless && limits.max > -kEndless) return std::nullopt;
    return Error{ErrorCode::NonFinite, name.Text() + ".min and " + name.Text() + ".max are the same infinity"};
}

MaybeError CheckMotor(const FieldName& name, const JointMotor& motor) {
    return FirstOf(CheckEnum({name, ".mode"}, motor.mode, MotorMode::ToPosition),
                   CheckFiniteField({name, ".targetSpeed"}, motor.targetSpeed),
                   CheckFiniteField({name, ".targetPosition"}, motor.targetPosition),
                   CheckSpring({name, ".spring"}, motor.spring),
                   CheckBetween({name, ".minForce"}, motor.minForce, -kEndless, 0.0),
                   CheckBetween({name, ".maxForce"}, motor.maxForce, 0.0, kEndless));
}

MaybeError CheckFriction(const FieldName& field, float x) {
    if (std::isfinite(x) && x >= 0.0f) return std::nullopt;
    return CheckNotNegative(field.Text().c_str(), x);
}

// A ratio of gears and the like, of either sign. Times the largest lengths it is still a float, and so is its inverse.
MaybeError CheckRatio(const FieldName& field, float x) {
    constexpr float kLeast = 1e-9f, kLargest = 1e9f;
    if (MaybeError e = CheckFiniteField(field, x)) return e;
    if (std::fabs(x) >= kLeast && std::fabs(x) <= kLargest) return std::nullopt;
    return Error{ErrorCode::OutOfRange, field.Text() + " is " + Number(x) + "; without its sign it must be from " +
                                            Number(kLeast) + " to " + Number(kLargest)};
}

MaybeError CheckBounds(const FieldName& name, const JointLimits& limits, const LimitBounds& bounds) {
    if (MaybeError e = FirstOf(CheckBetween({name, ".min"}, limits.min, bounds.lowest, bounds.highestMin),
                               CheckBetween({name, ".max"}, limits.max, bounds.lowestMax, bounds.highest)))
        return e;
    if (!bounds.symmetric || limits.min == -limits.max) return std::nullopt;
    return Error{ErrorCode::OutOfRange, name.Text() + " are " + Number(limits.min) + " and " + Number(limits.max) +
                                            "; for an ellipse they must be the same to both sides"};
}

// Rotations limited as swing and twist.
MaybeError CheckSwingTwist(const std::array<const char*, 3>& names, const std::array<AxisControl, 3>& axes,
                           SwingShape shape) {
    if (MaybeError e = CheckEnum("shape", shape, SwingShape::Pyramid)) return e;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<size_t>(k);
        if (MaybeError e = CheckControl(names[i], axes[i], AngularControls::BoundsOf(k, shape))) return e;
    }
    return std::nullopt;
}

// Both a kind's own fields and the shared ones.
template <class... Checks>
MaybeError CheckWith(const JointSettings& settings, Checks&&... checks) {
    return FirstOf(CheckCommon(settings), std::forward<Checks>(checks)...);
}

}  // namespace

Quaternion RotationOf(const JointAnchor& anchor) {
    const Vector3 axis = Normalized(anchor.axis);
    return RotationFromAxesXY(axis, anchor.normal ? *anchor.normal : Perpendicular(axis));
}

MaybeError CheckCommon(const JointSettings& s) {
    return FirstOf(CheckEnum("space", s.space, JointSpace::Body), CheckAnchor("anchorA", s.anchorA),
                   s.anchorB ? CheckAnchor("anchorB", *s.anchorB) : std::nullopt,
                   CheckEnum("priority", s.priority, JointPriority::High), CheckBreak("breakForce", s.breakForce),
                   CheckBreak("breakTorque", s.breakTorque), CheckRange("substeps", s.substeps, 0, 64),
                   CheckRange("velocityIterations", s.velocityIterations, 0, 255),
                   CheckRange("positionIterations", s.positionIterations, 0, 255),
                   CheckMassOverride("massOverride", s.massOverride));
}

MaybeError CheckMassOverride(const FieldName& name, const MassOverride& o) {
    const auto check = [&](const char* part, float scale) -> MaybeError {
        const FieldName field(name, part);
        if (MaybeError e = CheckFiniteField(field, scale)) return e;
        return CheckBetween(field, scale, 0, MassOverride::kLargestScale);
    };
    return FirstOf(
        check(".inverseMassScaleA", o.inverseMassScaleA), check(".inverseInertiaScaleA", o.inverseInertiaScaleA),
        check(".inverseMassScaleB", o.inverseMassScaleB), check(".inverseInertiaScaleB", o.inverseInertiaScaleB));
}

MaybeError CheckControl(const FieldName& name, const AxisControl& control, const LimitBounds& bounds) {
    return FirstOf(CheckLimits({name, ".limits"}, control.limits), CheckMotor({name, ".motor"}, control.motor),
                   CheckFriction({name, ".friction"}, control.friction),
                   control.limited ? CheckBounds({name, ".limits"}, control.limits, bounds) : std::nullopt);
}

MaybeError Check(const PointJointSettings& s) { return CheckCommon(s); }
MaybeError Check(const FixedJointSettings& s) { return CheckCommon(s); }
MaybeError Check(const DistanceJointSettings& s) {
    const double min = s.minDistance.value_or(0.0f), max = s.maxDistance ? *s.maxDistance : kEndless;
    return CheckWith(s, CheckNotNegative("minDistance", min), CheckBetween("maxDistance", max, 0.0, kEndless),
                     CheckOrder("minDistance", min, "maxDistance", max), CheckSpring("spring", s.spring));
}
MaybeError Check(const HingeJointSettings& s) { return CheckWith(s, CheckControl("angle", s.angle)); }
MaybeError Check(const SliderJointSettings& s) { return CheckWith(s, CheckControl("slide", s.slide)); }
MaybeError Check(const ConeJointSettings& s) {
    return CheckWith(s, CheckRange("halfAngle", s.halfAngle, 0.0, kHalfTurn), CheckSpring("spring", s.spring));
}
MaybeError Check(const SwingTwistJointSettings& s) {
    return CheckWith(s, CheckSwingTwist({"twist", "swingY", "swingZ"}, {s.twist, s.swingY, s.swingZ}, s.shape));
}
MaybeError Check(const SixDofJointSettings& s) {
    if (MaybeError e = CheckWith(s, CheckControl("axes[LinearX]", s.axes[0]), CheckControl("axes[LinearY]", s.axes[1]),
                                 CheckControl("axes[LinearZ]", s.axes[2])))
        return e;
    return CheckSwingTwist({"axes[AngularX]", "axes[AngularY]", "axes[AngularZ]"}, {s.axes[3], s.axes[4], s.axes[5]},
                           s.shape);
}
MaybeError Check(const GearJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }
MaybeError Check(const RackAndPinionJointSettings& s) { return CheckWith(s, CheckRatio("ratio", s.ratio)); }
MaybeError Check(const PulleyJointSettings& s) {
    if (MaybeError e = CheckWith(s, CheckPosition("fixedPointA", s.fixedPointA),
                                 CheckPosition("fixedPointB", s.fixedPointB), CheckPositive("ratio", s.ratio),
                                 CheckRatio("ratio", s.ratio), CheckNotNegative("minLength", s.minLength)))
        return e;
    if (!s.maxLength) return std::nullopt;
    return FirstOf(CheckBetween("maxLength", *s.maxLength, 0.0, kEndless),
                   CheckOrder("minLength", s.minLength, "maxLength", *s.maxLength));
}
MaybeError Check(const PathJointSettings& s) {
    if (MaybeError e =
            CheckWith(s, CheckControl("along", s.along), CheckEnum("rotation", s.rotation, PathRotation::Constant)))
        return e;
    if (s.path) return std::nullopt;
    return Error{ErrorCode::Unsupported, "path is null; the joint needs one"};
}
MaybeError Check(const WheelJointSettings& s) {
    return CheckWith(s, CheckControl("suspension", s.suspension), CheckControl("steering", s.steering),
                     CheckControl("spin", s.spin));
}
MaybeError Check(const CustomJointSettings& s) {
    if (MaybeError e = CheckCommon(s)) return e;
    if (s.make) return std::nullopt;
    return Error{ErrorCode::Unsupported, "make is empty; the joint needs a type"};
}

std::unique_ptr<JointType> MakeType(const PointJointSettings&) {
    return std::make_unique<LockJoint>(JointLocks{.linear = LinearLock::Point});
}
std::unique_ptr<JointType> MakeType(const FixedJointSettings&) {
    return std::make_unique<LockJoint>(JointLocks{.linear = LinearLock::Point, .angular = AngularLock::All});
}
std::unique_ptr<JointType> MakeType(const DistanceJointSettings& s) {
    return std::make_unique<DistanceJoint>(s.minDistance, s.maxDistance, s.spring);
}
std::unique_ptr<JointType> MakeType(const HingeJointSettings& s) { return std::make_unique<HingeJoint>(s.angle); }
std::unique_ptr<JointType> MakeType(const SliderJointSettings& s) { return std::make_unique<SliderJoint>(s.slide); }
std::unique_ptr<JointType> MakeType(const ConeJointSettings& s) {
    return std::make_unique<ConeJoint>(s.halfAngle, s.spring);
}
std::unique_ptr<JointType> MakeType(const SwingTwistJointSettings& s) {
    return std::make_unique<SwingTwistJoint>(s.twist, s.swingY, s.swingZ, s.shape);
}
std::unique_ptr<JointType> MakeType(const SixDofJointSettings& s) {
    return std::make_unique<SixDofJoint>(s.axes, s.shape);
}
std::unique_ptr<JointType> MakeType(const GearJointSettings& s) { return std::make_unique<GearJoint>(s.ratio); }
std::unique_ptr<JointType> MakeType(const RackAndPinionJointSettings& s) {
    return std::make_unique<RackAndPinionJoint>(s.ratio);
}
std::unique_ptr<JointType> MakeType(const PulleyJointSettings& s) {
    return std::make_unique<PulleyJoint>(s.fixedPointA, s.fixedPointB, s.ratio, s.minLength, s.maxLength);
}
std::unique_ptr<JointType> MakeType(const PathJointSettings& s) {
    return std::make_unique<PathJoint>(s.path, s.along, s.rotation);
}
std::unique_ptr<JointType> MakeType(const WheelJointSettings& s) {
    return std::make_unique<WheelJoint>(s.suspension, s.isSteered, s.steering, s.spin);
}
std::unique_ptr<JointType> MakeType(const CustomJointSettings& s) { return s.make(); }

}  // namespace fulcrum
