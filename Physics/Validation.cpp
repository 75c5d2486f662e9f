#include <Fulcrum/Physics/Validation.h>

#include <cmath>
#include <cstdio>
#include <limits>

namespace fulcrum {

namespace {

std::string Number(double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

template <class V>
MaybeError CheckFiniteVector(const char* field, const V& v) {
    if (IsFinite(v)) return std::nullopt;
    return Error{ErrorCode::NonFinite, std::string(field) + " is (" + Number(v.x()) + ", " + Number(v.y()) + ", " +
                                           Number(v.z()) + "); it must be finite"};
}

Error FiniteError(const char* field, double x) {
    return {ErrorCode::NonFinite, std::string(field) + " is " + Number(x) + "; it must be finite"};
}

}  // namespace

MaybeError CheckFinite(const char* field, const Vector3& value) { return CheckFiniteVector(field, value); }
MaybeError CheckFinite(const char* field, const Position& value) { return CheckFiniteVector(field, value); }

MaybeError CheckPosition(const char* field, const Position& value) {
    constexpr double kFarthest = 1e18;  // m
    if (MaybeError e = CheckFinite(field, value)) return e;
    const double farthest = value.cwiseAbs().maxCoeff();
    if (farthest <= kFarthest) return std::nullopt;
    return Error{ErrorCode::OutOfRange, std::string(field) + " is " + Number(farthest) +
                                            " m along an axis; it must be at most " + Number(kFarthest)};
}

Error RangeError(const char* field, double value, double low, double high) {
    if (!std::isfinite(value)) return FiniteError(field, value);
    return Error{ErrorCode::OutOfRange, std::string(field) + " is " + Number(value) + "; it must be from " +
                                            Number(low) + " to " + Number(high)};
}

Error PositiveError(const char* field, double value) {
    if (!std::isfinite(value)) return FiniteError(field, value);
    return Error{ErrorCode::NonPositive, std::string(field) + " is " + Number(value) + "; it must be larger than 0"};
}

static MaybeError CheckPositiveOrInfinite(const char* field, double value) {
    return value == std::numeric_limits<double>::infinity() ? std::nullopt : CheckPositive(field, value);
}

MaybeError CheckTarget(const char* field, double value) {
    return value == std::numeric_limits<double>::infinity() ? std::nullopt : CheckNotNegative(field, value);
}

Error NegativeError(const char* field, double value) {
    if (!std::isfinite(value)) return FiniteError(field, value);
    return Error{ErrorCode::Negative, std::string(field) + " is " + Number(value) + "; it must be 0 or more"};
}

MaybeError CheckRotation(const char* field, const Quaternion& value) {
    if (!IsFinite(value))
        return Error{ErrorCode::NonFinite, std::string(field) + " has a component that is not finite"};
    const double length = std::sqrt(double(LengthSquared(value)));
    if (std::fabs(length - 1.0) <= 1e-3) return std::nullopt;
    return Error{ErrorCode::Unnormalized, std::string(field) + " has length " + Number(length) + "; it must be 1"};
}

MaybeError Check(const Material& m) {
    return FirstOf(CheckNotNegative("material.friction", m.friction),
                   CheckRange("material.friction", m.friction, 0, kMostFriction),
                   CheckRange("material.restitution", m.restitution, 0, 1),
                   CheckEnum("material.frictionRule", m.frictionRule, CombineRule::Maximum),
                   CheckEnum("material.restitutionRule", m.restitutionRule, CombineRule::Maximum));
}

MaybeError CheckContinuous(ContinuousCollision continuous, const Shape& shape) {
    if (MaybeError e = CheckEnum("continuous", continuous, ContinuousCollision::LinearAndAngular)) return e;
    if (continuous != ContinuousCollision::Off && (shape.IsSurface() || shape.Type() == ShapeType::Plane))
        return Error{ErrorCode::Unsupported, std::string("continuous is set for a ") + ShapeTypeName(shape.Type()) +
                                                 "; it is for convex shapes and compounds"};
    return std::nullopt;
}

MaybeError CheckSensor(SensorSees sees) { return CheckEnum("sensorSees", sees, SensorSees::All); }

MaybeError CheckInverses(const char* massField, const char* inertiaField, float mass, const Vector3& inertia) {
    const auto usable = [](float x) { return std::isnormal(x) && std::isnormal(1.0f / x); };
    if (!usable(mass))
        return Error{ErrorCode::OutOfRange, std::string(massField) + " makes a mass of " + Number(mass) +
                                                " kg; it and its inverse must be normal floats"};
    for (int k = 0; k < 3; ++k)
        if (!usable(inertia[k]))
            return Error{ErrorCode::OutOfRange, std::string(inertiaField) + " makes a moment of inertia of " +
                                                    Number(inertia[k]) +
                                                    " kg m2; it and its inverse must be normal floats"};
    return std::nullopt;
}

static MaybeError CheckInverses(const BodySettings& s) {
    const char* massField = s.mass > 0 ? "mass" : "density";
    const float mass = s.mass > 0 ? s.mass : s.density * s.shape->Mass().volume;
    if (!s.inertia.isZero(0)) return CheckInverses(massField, "inertia", mass, s.inertia);
    return CheckInverses(massField, massField, mass,
                         Vector3(s.shape->Mass().principalInertia * (mass / s.shape->Mass().volume)));
}

MaybeError CheckShape(const Shape* shape, MotionType motion) {
    if (!shape) return Error{ErrorCode::Unsupported, "shape is null; a body needs one"};
    if (motion == MotionType::Dynamic && (shape->IsSurface() || shape->Type() == ShapeType::Plane))
        return Error{ErrorCode::Unsupported, std::string("shape is a ") + ShapeTypeName(shape->Type()) +
                                                 "; a dynamic body needs one with a volume"};
    // Only custom shapes, and shapes that contain one, can fail: all others are checked when created.
    const Bounds& box = shape->LocalBounds();
    if (shape->Type() != ShapeType::Plane && shape->Type() != ShapeType::Empty &&
        !(IsFinite(box.lower) && IsFinite(box.upper)))
        return Error{ErrorCode::NonFinite,
                     std::string("shape is a ") + ShapeTypeName(shape->Type()) + " whose bounds are not finite"};
    return std::nullopt;
}

Error Unknown(BodyId id) {
    return {ErrorCode::UnknownId, "no body has the id (index " + std::to_string(id.index) + ", generation " +
                                      std::to_string(id.generation) + ")"};
}

MaybeError Check(const BodySettings& s) {
    if (MaybeError e = CheckEnum("motion", s.motion, MotionType::Dynamic)) return e;
    if (MaybeError e = CheckShape(s.shape.get(), s.motion)) return e;
    if (MaybeError e = FirstOf(CheckPosition("position", s.position), CheckRotation("rotation", s.rotation),
                               CheckFinite("linearVelocity", s.linearVelocity),
                               CheckFinite("angularVelocity", s.angularVelocity), CheckPositive("density", s.density),
                               CheckNotNegative("mass", s.mass), CheckFinite("inertia", s.inertia)))
        return e;
    if (!s.inertia.isZero(0) && !(s.inertia.minCoeff() > 0))
        return Error{ErrorCode::NonPositive, "inertia must be larger than 0 in all three components, or zero in all"};
    if (MaybeError e = FirstOf(
            Check(s.material), CheckTarget("penetrationTarget", s.penetrationTarget),
            CheckNotNegative("linearDamping", s.linearDamping), CheckNotNegative("angularDamping", s.angularDamping),
            CheckRange("gravityFactor", s.gravityFactor, -1e6, 1e6), CheckPositive("maxLinearSpeed", s.maxLinearSpeed),
            CheckPositive("maxAngularSpeed", s.maxAngularSpeed), CheckRange("layer", s.layer, 0, 31),
            CheckRange("lockedAxes", static_cast<uint8_t>(s.lockedAxes), 0, 63)))
        return e;
    if (s.motion == MotionType::Dynamic)
        if (MaybeError e = CheckInverses(s)) return e;
    if (MaybeError e = FirstOf(CheckContinuous(s.continuous, *s.shape), CheckSensor(s.sensorSees))) return e;
    if (s.isSensor && s.continuous != ContinuousCollision::Off)
        return Error{ErrorCode::Unsupported, "continuous is set for a sensor, which touches nothing"};
    if (s.startAsleep && s.motion != MotionType::Dynamic)
        return Error{ErrorCode::Unsupported, "startAsleep is set for a body that is not dynamic"};
    if (s.motion == MotionType::Static && !(s.linearVelocity.isZero(0) && s.angularVelocity.isZero(0)))
        return Error{ErrorCode::Unsupported, "a static body was given a velocity"};
    return std::nullopt;
}

MaybeError Check(const SystemSettings& s) {
    // Upper bound of settings whose products would otherwise overflow a float.
    constexpr double kMost = 1e6;
    if (MaybeError e = FirstOf(
            CheckFinite("gravity", s.gravity), CheckRange("gravity", double{s.gravity.cwiseAbs().maxCoeff()}, 0, kMost),
            CheckRange("solver.substeps", s.solver.substeps, 1, 255),
            CheckPositiveOrInfinite("accuracy.penetration", s.accuracy.penetration),
            CheckPositiveOrInfinite("accuracy.jointError", s.accuracy.jointError),
            CheckRange("solver.velocityIterations", s.solver.velocityIterations, 1, 255),
            CheckRange("solver.positionIterations", s.solver.positionIterations, 0, 255),
            CheckEnum("solver.positionCorrection", s.solver.positionCorrection, PositionCorrection::Baumgarte),
            CheckPositive("solver.baumgarte", s.solver.baumgarte),
            CheckRange("solver.baumgarte", s.solver.baumgarte, 0, 1),
            CheckRange("solver.baumgarteSlop", s.solver.baumgarteSlop, 0, 1000),
            CheckEnum("narrowPhase", s.narrowPhase, NarrowPhaseMethod::Libccd),
            CheckNotNegative("sleep.seconds", s.sleep.seconds),
            CheckNotNegative("sleep.linearSpeed", s.sleep.linearSpeed),
            CheckPositive("speculativeDistance", s.speculativeDistance),
            CheckRange("speculativeDistance", s.speculativeDistance, 0, 1000),
            CheckNotNegative("penetrationSlop", s.penetrationSlop),
            CheckPositiveOrInfinite("contactFrequency", s.contactFrequency),
            CheckNotNegative("contactDampingRatio", s.contactDampingRatio),
            CheckRange("contactDampingRatio", s.contactDampingRatio, 0, kMost),
            CheckPositive("contactPushSpeed", s.contactPushSpeed),
            CheckRange("contactPushSpeed", s.contactPushSpeed, 0, kMost),
            CheckPositive("depenetrationSpeed", s.depenetrationSpeed),
            CheckRange("depenetrationSpeed", s.depenetrationSpeed, 0, kMost),
            CheckPositive("jointPushSpeed", s.jointPushSpeed), CheckRange("jointPushSpeed", s.jointPushSpeed, 0, kMost),
            CheckPositiveOrInfinite("exactJointLoad", s.exactJointLoad),
            CheckNotNegative("restitutionSpeed", s.restitutionSpeed), CheckPositive("boundsMargin", s.boundsMargin)))
        return e;
    if (s.narrowPhase == NarrowPhaseMethod::Libccd && !HasLibccd())
        return Error{ErrorCode::Unsupported, "narrowPhase is Libccd, which this build does not contain"};
    for (size_t i = 0; i < 32; ++i)
        for (size_t j = 0; j < i; ++j)
            if ((s.layerCollides[i] >> j & 1) != (s.layerCollides[j] >> i & 1))
                return Error{ErrorCode::Unsupported, "layerCollides is not symmetric for layers " + std::to_string(j) +
                                                         " and " + std::to_string(i)};
    return std::nullopt;
}

}  // namespace fulcrum
