#include <Fulcrum/Physics/Joints/JointChecks.h>

#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>

#include <cmath>
#include <cstdio>
#include <limits>

namespace fulcrum {

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

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

MaybeError CheckLimits(const FieldName& name, const JointLimits& limits) {
    if (MaybeError e = FirstOf(CheckNotNaN({name, ".min"}, limits.min), CheckNotNaN({name, ".max"}, limits.max),
                               CheckOrder({name, ".min"}, limits.min, {name, ".max"}, limits.max),
                               CheckSpring({name, ".spring"}, limits.spring)))
        return e;
    if (limits.min < kEndless && limits.max > -kEndless) return std::nullopt;
    return Error{ErrorCode::NonFinite, name.Text() + ".min and " + name.Text() + ".max are the same infinity"};
}

MaybeError CheckMode(const FieldName& field, MotorMode mode) {
    if (mode <= MotorMode::ToPosition) return std::nullopt;
    return CheckEnum(field.Text().c_str(), mode, MotorMode::ToPosition);
}

MaybeError CheckMotor(const FieldName& name, const JointMotor& motor) {
    return FirstOf(CheckMode({name, ".mode"}, motor.mode), CheckFiniteField({name, ".targetSpeed"}, motor.targetSpeed),
                   CheckFiniteField({name, ".targetPosition"}, motor.targetPosition),
                   CheckSpring({name, ".spring"}, motor.spring),
                   CheckBetween({name, ".minForce"}, motor.minForce, -kEndless, 0.0),
                   CheckBetween({name, ".maxForce"}, motor.maxForce, 0.0, kEndless));
}

MaybeError CheckFriction(const FieldName& field, float x) {
    if (std::isfinite(x) && x >= 0.0f) return std::nullopt;
    return CheckNotNegative(field.Text().c_str(), x);
}

MaybeError CheckBounds(const FieldName& name, const JointLimits& limits, const LimitBounds& bounds) {
    if (MaybeError e = FirstOf(CheckBetween({name, ".min"}, limits.min, bounds.lowest, bounds.highestMin),
                               CheckBetween({name, ".max"}, limits.max, bounds.lowestMax, bounds.highest)))
        return e;
    if (!bounds.symmetric || limits.min == -limits.max) return std::nullopt;
    return Error{ErrorCode::OutOfRange, name.Text() + " are " + Number(limits.min) + " and " + Number(limits.max) +
                                            "; for an ellipse they must be the same to both sides"};
}

}  // namespace

MaybeError CheckJointBodies(const JointSettings& settings, FunctionRef<std::optional<MotionType>(BodyId)> motionOf) {
    const std::optional<MotionType> a = motionOf(settings.bodyA), b = motionOf(settings.bodyB);
    const auto unknown = [](const char* field, BodyId id) {
        return Error{ErrorCode::UnknownId, std::string(field) + ": no body has the id (index " +
                                               std::to_string(id.index) + ", generation " +
                                               std::to_string(id.generation) + ")"};
    };
    if (!a) return unknown("bodyA", settings.bodyA);
    if (!b) return unknown("bodyB", settings.bodyB);
    if (settings.bodyA == settings.bodyB)
        return Error{ErrorCode::Unsupported, "bodyA and bodyB are the same; a joint needs two bodies"};
    if (*a != MotionType::Dynamic && *b != MotionType::Dynamic)
        return Error{ErrorCode::Unsupported, "bodyA and bodyB are both not dynamic; a joint needs one that moves"};
    return std::nullopt;
}

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

MaybeError CheckSpring(const FieldName& name, const SpringSettings& spring) {
    const Status status = Validate(spring);
    if (status) return std::nullopt;
    // The messages begin with "spring ".
    return Error{status.GetError().code, name.Text() + "." + status.GetError().message.substr(7)};
}

MaybeError CheckRatio(const FieldName& field, float x) {
    constexpr float kLeast = 1e-9f, kLargest = 1e9f;
    if (MaybeError e = CheckFiniteField(field, x)) return e;
    if (std::fabs(x) >= kLeast && std::fabs(x) <= kLargest) return std::nullopt;
    return Error{ErrorCode::OutOfRange, field.Text() + " is " + Number(x) + "; without its sign it must be from " +
                                            Number(kLeast) + " to " + Number(kLargest)};
}

MaybeError CheckSwingTwist(const std::array<const char*, 3>& names, const std::array<AxisControl, 3>& axes,
                           SwingShape shape) {
    if (MaybeError e = CheckEnum("shape", shape, SwingShape::Pyramid)) return e;
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<size_t>(k);
        if (MaybeError e = CheckControl(names[i], axes[i], AngularControls::BoundsOf(k, shape))) return e;
    }
    return std::nullopt;
}

Quaternion RotationOf(const JointAnchor& anchor) {
    const Vector3 axis = Normalized(anchor.axis);
    return RotationFromAxesXY(axis, anchor.normal ? *anchor.normal : Perpendicular(axis));
}

void SetNormalNear(JointAnchor& anchor, const Vector3& wanted) {
    const Vector3 axis = Normalized(anchor.axis);
    const Vector3 flat = wanted - axis * Dot(axis, wanted);
    if (LengthSquared(flat) > 1e-6f) anchor.normal = Normalized(flat);
}

MaybeError CheckCommon(const JointSettings& s) {
    return FirstOf(CheckEnum("space", s.space, JointSpace::Body), CheckAnchor("anchorA", s.anchorA),
                   s.anchorB ? CheckAnchor("anchorB", *s.anchorB) : std::nullopt,
                   CheckEnum("priority", s.priority, JointPriority::High), CheckBreak("breakForce", s.breakForce),
                   CheckBreak("breakTorque", s.breakTorque), CheckRange("substeps", s.substeps, 0, 64),
                   CheckRange("velocityIterations", s.velocityIterations, 0, 255),
                   CheckRange("positionIterations", s.positionIterations, 0, 255),
                   CheckTarget("errorTarget", s.errorTarget), CheckMassOverride("massOverride", s.massOverride));
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

}  // namespace fulcrum
