// Invalid settings of joints: the error names the field. Valid ones, also the defaults, create a joint.
#include <Fulcrum/Physics/Joints/JointKinds.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kEndless = std::numeric_limits<float>::infinity();

struct NoType final : JointType {};

template <class Settings>
void ExpectValid(const Settings& settings) {
    const MaybeError error = Check(settings);
    EXPECT_FALSE(error) << (error ? error->message : "");
    EXPECT_NE(MakeType(settings), nullptr);
}

// `change` makes one field invalid.
template <class Settings, class Change>
void ExpectError(Settings settings, Change&& change, ErrorCode code, const std::string& field) {
    change(settings);
    const MaybeError error = Check(settings);
    ASSERT_TRUE(error) << field;
    EXPECT_EQ(error->code, code) << error->message;
    EXPECT_TRUE(error->message.starts_with(field + " ")) << error->message;
}

TEST(JointValidation, EveryDefaultWorks) {
    const auto expect = []<class Settings>(Settings settings) {
        if constexpr (requires { settings.make; }) settings.make = [] { return std::make_unique<NoType>(); };
        ExpectValid(settings);
    };
#define FULCRUM_EXPECT(kind) expect(kind##JointSettings{});
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_EXPECT)
#undef FULCRUM_EXPECT
}

TEST(JointValidation, NamesTheFieldThatAllJointsShare) {
    using S = PointJointSettings;
    const auto expect = [](auto&& change, ErrorCode code, const char* field) { ExpectError(S{}, change, code, field); };
    expect([](S& s) { s.anchorA.point.y() = std::numeric_limits<double>::quiet_NaN(); }, ErrorCode::NonFinite,
           "anchorA.point");
    expect([](S& s) { s.anchorA.axis = Vector3(0, kNaN, 0); }, ErrorCode::NonFinite, "anchorA.axis");
    expect([](S& s) { s.anchorA.axis = Vector3::Zero(); }, ErrorCode::Unnormalized, "anchorA.axis");
    expect([](S& s) { s.anchorA.axis = Vector3(0, 2, 0); }, ErrorCode::Unnormalized, "anchorA.axis");
    expect([](S& s) { s.anchorA.normal = Vector3(1, 0, 0); }, ErrorCode::Degenerate, "anchorA.normal");
    expect([](S& s) { s.anchorA.normal = Vector3(0, 0.5f, 0); }, ErrorCode::Unnormalized, "anchorA.normal");
    expect([](S& s) { s.anchorB = s.anchorA, s.anchorB->axis = Vector3(0, 0, 3); }, ErrorCode::Unnormalized,
           "anchorB.axis");
    expect([](S& s) { s.breakForce = 0.0f; }, ErrorCode::NonPositive, "breakForce");
    expect([](S& s) { s.breakForce = kNaN; }, ErrorCode::NonFinite, "breakForce");
    expect([](S& s) { s.breakTorque = -1.0f; }, ErrorCode::NonPositive, "breakTorque");
    expect([](S& s) { s.substeps = 65; }, ErrorCode::OutOfRange, "substeps");
    expect([](S& s) { s.substeps = -1; }, ErrorCode::OutOfRange, "substeps");
    expect([](S& s) { s.velocityIterations = 256; }, ErrorCode::OutOfRange, "velocityIterations");
    expect([](S& s) { s.positionIterations = -1; }, ErrorCode::OutOfRange, "positionIterations");
    expect([](S& s) { s.massOverride.inverseMassScaleA = kNaN; }, ErrorCode::NonFinite,
           "massOverride.inverseMassScaleA");
    expect([](S& s) { s.massOverride.inverseMassScaleB = -0.5f; }, ErrorCode::OutOfRange,
           "massOverride.inverseMassScaleB");
    expect([](S& s) { s.massOverride.inverseInertiaScaleA = 1.1e6f; }, ErrorCode::OutOfRange,
           "massOverride.inverseInertiaScaleA");
    expect([](S& s) { s.massOverride.inverseInertiaScaleB = kEndless; }, ErrorCode::NonFinite,
           "massOverride.inverseInertiaScaleB");
    expect([](S& s) { s.space = static_cast<JointSpace>(7); }, ErrorCode::OutOfRange, "space");
    expect([](S& s) { s.priority = static_cast<JointPriority>(7); }, ErrorCode::OutOfRange, "priority");
}

TEST(JointValidation, NamesTheFieldOfAControl) {
    using S = HingeJointSettings;
    const auto expect = [](auto&& change, ErrorCode code, const char* field) { ExpectError(S{}, change, code, field); };
    expect([](S& s) { s.angle.limits.min = 1.0f; }, ErrorCode::OutOfRange, "angle.limits.min");
    expect([](S& s) { s.angle.limits.min = kNaN; }, ErrorCode::NonFinite, "angle.limits.min");
    expect([](S& s) { s.angle.limits.max = kNaN; }, ErrorCode::NonFinite, "angle.limits.max");
    expect([](S& s) { s.angle.limits.min = s.angle.limits.max = kEndless; }, ErrorCode::NonFinite, "angle.limits.min");
    expect([](S& s) { s.angle.limits.spring.frequency = -1.0f; }, ErrorCode::Negative, "angle.limits.spring.frequency");
    expect([](S& s) { s.angle.limits.spring.stiffness = -1.0f; }, ErrorCode::Negative, "angle.limits.spring.stiffness");
    expect([](S& s) { s.angle.motor.spring.dampingRatio = kNaN; }, ErrorCode::NonFinite,
           "angle.motor.spring.dampingRatio");
    expect([](S& s) { s.angle.motor.targetSpeed = kEndless; }, ErrorCode::NonFinite, "angle.motor.targetSpeed");
    expect([](S& s) { s.angle.motor.targetPosition = kNaN; }, ErrorCode::NonFinite, "angle.motor.targetPosition");
    expect([](S& s) { s.angle.motor.minForce = 1.0f; }, ErrorCode::OutOfRange, "angle.motor.minForce");
    expect([](S& s) { s.angle.motor.maxForce = -1.0f; }, ErrorCode::OutOfRange, "angle.motor.maxForce");
    expect([](S& s) { s.angle.motor.mode = static_cast<MotorMode>(9); }, ErrorCode::OutOfRange, "angle.motor.mode");
    expect([](S& s) { s.angle.friction = -0.5f; }, ErrorCode::Negative, "angle.friction");
    ExpectError(
        SliderJointSettings{}, [](auto& s) { s.slide.friction = kNaN; }, ErrorCode::NonFinite, "slide.friction");

    S beyond;
    beyond.angle.limited = true;
    beyond.angle.limits.min = -kEndless;
    beyond.angle.limits.max = 50.0f;
    ExpectValid(beyond);
}

TEST(JointValidation, NamesTheFieldOfEachKind) {
    ExpectError(
        DistanceJointSettings{}, [](auto& s) { s.minDistance = -1.0f; }, ErrorCode::Negative, "minDistance");
    ExpectError(
        DistanceJointSettings{}, [](auto& s) { s.minDistance = 2.0f, s.maxDistance = 1.0f; }, ErrorCode::OutOfRange,
        "minDistance");
    ExpectError(
        DistanceJointSettings{}, [](auto& s) { s.maxDistance = kNaN; }, ErrorCode::NonFinite, "maxDistance");
    ExpectError(
        DistanceJointSettings{}, [](auto& s) { s.spring.damping = -1.0f; }, ErrorCode::Negative, "spring.damping");
    ExpectError(
        ConeJointSettings{}, [](auto& s) { s.halfAngle = -0.1f; }, ErrorCode::OutOfRange, "halfAngle");
    ExpectError(
        ConeJointSettings{}, [](auto& s) { s.halfAngle = 3.2f; }, ErrorCode::OutOfRange, "halfAngle");
    ExpectError(
        GearJointSettings{}, [](auto& s) { s.ratio = 0.0f; }, ErrorCode::OutOfRange, "ratio");
    ExpectError(
        GearJointSettings{}, [](auto& s) { s.ratio = kNaN; }, ErrorCode::NonFinite, "ratio");
    ExpectError(
        RackAndPinionJointSettings{}, [](auto& s) { s.ratio = 0.0f; }, ErrorCode::OutOfRange, "ratio");
    ExpectError(
        PulleyJointSettings{}, [](auto& s) { s.ratio = -1.0f; }, ErrorCode::NonPositive, "ratio");
    ExpectError(
        PulleyJointSettings{}, [](auto& s) { s.fixedPointB.x() = HUGE_VAL; }, ErrorCode::NonFinite, "fixedPointB");
    ExpectError(
        PulleyJointSettings{}, [](auto& s) { s.minLength = 3.0f, s.maxLength = 2.0f; }, ErrorCode::OutOfRange,
        "minLength");
    ExpectError(
        PulleyJointSettings{}, [](auto& s) { s.maxLength = -2.0f; }, ErrorCode::OutOfRange, "maxLength");
    ExpectError(
        PathJointSettings{}, [](auto& s) { s.path = nullptr; }, ErrorCode::Unsupported, "path");
    ExpectError(
        PathJointSettings{}, [](auto& s) { s.rotation = static_cast<PathRotation>(9); }, ErrorCode::OutOfRange,
        "rotation");
    ExpectError(
        PathJointSettings{}, [](auto& s) { s.along.friction = -1.0f; }, ErrorCode::Negative, "along.friction");
    ExpectError(
        WheelJointSettings{}, [](auto& s) { s.suspension.motor.spring.stiffness = -1.0f; }, ErrorCode::Negative,
        "suspension.motor.spring.stiffness");
    ExpectError(
        WheelJointSettings{}, [](auto& s) { s.steering.friction = -1.0f; }, ErrorCode::Negative, "steering.friction");
    ExpectError(
        WheelJointSettings{}, [](auto& s) { s.spin.motor.maxForce = kNaN; }, ErrorCode::NonFinite,
        "spin.motor.maxForce");
    ExpectError(
        CustomJointSettings{}, [](auto&) {}, ErrorCode::Unsupported, "make");
}

TEST(JointValidation, NamesTheFieldOfASwingAndATwist) {
    const auto limit = [](AxisControl& control, float min, float max) {
        control.limited = true;
        control.limits.min = min;
        control.limits.max = max;
    };
    using S = SwingTwistJointSettings;
    ExpectError(
        S{}, [&](S& s) { limit(s.twist, -4.0f, 0.0f); }, ErrorCode::OutOfRange, "twist.limits.min");
    ExpectError(
        S{}, [&](S& s) { limit(s.twist, 0.0f, 4.0f); }, ErrorCode::OutOfRange, "twist.limits.max");
    ExpectError(
        S{}, [&](S& s) { limit(s.swingY, 0.1f, 1.0f); }, ErrorCode::OutOfRange, "swingY.limits.min");
    ExpectError(
        S{}, [&](S& s) { limit(s.swingZ, -1.0f, -0.1f); }, ErrorCode::OutOfRange, "swingZ.limits.max");
    ExpectError(
        S{}, [&](S& s) { limit(s.swingZ, -1.0f, 0.5f); }, ErrorCode::OutOfRange, "swingZ.limits");
    ExpectError(
        S{}, [](S& s) { s.shape = static_cast<SwingShape>(5); }, ErrorCode::OutOfRange, "shape");
    ExpectError(
        S{}, [](S& s) { s.swingY.motor.maxForce = kNaN; }, ErrorCode::NonFinite, "swingY.motor.maxForce");
    ExpectError(
        SixDofJointSettings{}, [&](auto& s) { limit(s[JointAxis::AngularZ], -1.0f, -0.5f); }, ErrorCode::OutOfRange,
        "axes[AngularZ].limits.max");
    ExpectError(
        SixDofJointSettings{}, [](auto& s) { s[JointAxis::LinearY].friction = -1.0f; }, ErrorCode::Negative,
        "axes[LinearY].friction");
    S pyramid;
    pyramid.shape = SwingShape::Pyramid;
    limit(pyramid.swingY, -0.2f, 1.0f);
    limit(pyramid.twist, 0.5f, 3.14159265f);
    ExpectValid(pyramid);
    SixDofJointSettings soft;
    soft[JointAxis::LinearX] = kLockedAxis;
    soft[JointAxis::LinearX].limits.spring.frequency = 2.0f;
    ExpectValid(soft);
}

}  // namespace
}  // namespace fulcrum::testing
