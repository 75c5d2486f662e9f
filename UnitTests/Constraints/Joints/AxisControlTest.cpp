// Which rows an axis has and when, on a slider along x: its coordinate is that of B.
#include "JointCases.h"

#include <Fulcrum/Physics/Joints/SliderJoint.h>

namespace fulcrum::testing {
namespace {

using Kind = JointRow::Kind;
constexpr int kLow = ControlSlots::kLowLimit, kHigh = ControlSlots::kHighLimit, kMotor = ControlSlots::kMotor,
              kFriction = ControlSlots::kFriction;
constexpr float kDt = 1.0f / 60.0f;

std::map<int, JointRow> RowsAt(const AxisControl& control, float position, float speed = 0.0f) {
    JointBodies bodies;
    bodies.place[1].x() = position;
    bodies.velocity[1].linear.x() = speed;
    SliderJoint slider(control);
    return RowsOf(slider, bodies.Pose());
}

TEST(AxisControl, HasNoRowsUntilSomethingIsActive) {
    EXPECT_EQ(MaxControlRows({}), 0u);
    EXPECT_TRUE(RowsAt({}, 0.3f, 5.0f).empty());
    EXPECT_TRUE(RowsAt(Limited(-1, 1), 0.0f).empty());
    EXPECT_TRUE(RowsAt(Limited(-1, 1), 0.9f).empty());
}

TEST(AxisControl, LimitsHaveARowOnceTheyMayBeReachedWithinTheStep) {
    auto rows = RowsAt(Limited(-1, 1), 0.99f);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[kHigh].kind, Kind::AtLeast);
    EXPECT_NEAR(rows[kHigh].error, 0.01f, 1e-6f);
    EXPECT_EQ(rows[kHigh].jacobian.b.linear, Vector3(-1, 0, 0));
    // At 30 m/s half a meter is covered in a step; away from the limit there is none.
    EXPECT_TRUE(RowsAt(Limited(-1, 1), 0.5f, 30.0f).contains(kHigh));
    EXPECT_TRUE(RowsAt(Limited(-1, 1), 0.5f, -30.0f).empty());
    // Beyond it there is one at any speed.
    rows = RowsAt(Limited(-1, 1), -1.5f, 30.0f);
    ASSERT_TRUE(rows.contains(kLow));
    EXPECT_NEAR(rows[kLow].error, -0.5f, 1e-6f);
    EXPECT_EQ(rows[kLow].jacobian.b.linear, Vector3(1, 0, 0));
    // A narrow range: both.
    EXPECT_EQ(RowsAt(Limited(-0.01f, 0.01f), 0.0f).size(), 2u);
}

TEST(AxisControl, ALimitMayBeMissingOnOneSide) {
    constexpr float kEnd = std::numeric_limits<float>::infinity();
    EXPECT_TRUE(RowsAt(Limited(-kEnd, 1), -1e6f, -100.0f).empty());
    EXPECT_TRUE(RowsAt(Limited(-kEnd, 1), 1.0f).contains(kHigh));
}

TEST(AxisControl, SoftLimitsAreSprings) {
    AxisControl control = Limited(-1, 1);
    control.limits.spring.frequency = 3.0f;
    auto rows = RowsAt(control, 1.2f);
    EXPECT_EQ(rows[kHigh].kind, Kind::SpringAtLeast);
    EXPECT_EQ(rows[kHigh].spring.frequency, 3.0f);
}

TEST(AxisControl, EqualLimitsLockTheAxisAndDisableTheRest) {
    AxisControl control = Limited(0.25f, 0.25f);
    control.motor.mode = MotorMode::ToVelocity;
    control.friction = 1.0f;
    auto rows = RowsAt(control, 1.0f);
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[kLow].kind, Kind::Equal);
    EXPECT_NEAR(rows[kLow].error, 0.75f, 1e-6f);
    EXPECT_EQ(MaxControlRows(control), 1u);
    control.limits.spring = {.mode = SpringMode::StiffnessAndDamping, .stiffness = 10.0f};
    EXPECT_EQ(RowsAt(control, 1.0f)[kLow].kind, Kind::Spring);
}

TEST(AxisControl, MotorsPassTheirTargetsAndForces) {
    AxisControl control = Driven(MotorMode::ToVelocity, 2.0f);
    control.motor.minForce = -3.0f;
    control.motor.maxForce = 4.0f;
    JointRow row = RowsAt(control, 0.5f)[kMotor];
    EXPECT_EQ(row.kind, Kind::Speed);
    EXPECT_EQ(row.speed, 2.0f);
    EXPECT_EQ(row.minForce, -3.0f);
    EXPECT_EQ(row.maxForce, 4.0f);

    control = Driven(MotorMode::ToPosition, 2.0f);
    control.motor.maxForce = 4.0f;
    row = RowsAt(control, 0.5f)[kMotor];
    EXPECT_EQ(row.kind, Kind::Spring);
    EXPECT_NEAR(row.error, -1.5f, 1e-6f);
    EXPECT_EQ(row.maxForce, 4.0f);
    control.motor.spring = {};
    EXPECT_EQ(RowsAt(control, 0.5f)[kMotor].kind, Kind::Equal);
}

TEST(AxisControl, PositionTargetsEndAtTheLimits) {
    AxisControl control = Driven(MotorMode::ToPosition, 5.0f);
    control.limited = true;
    control.limits.min = -1.0f;
    control.limits.max = 1.0f;
    EXPECT_NEAR(RowsAt(control, 0.5f)[kMotor].error, -0.5f, 1e-6f);
}

TEST(AxisControl, AMotorComesToAHardLimitButNotBeyond) {
    // Each step leaves the part of a substep of the way: a fifth.
    AxisControl control = Limited(-1, 1);
    for (const float speed : {1.0f, 40.0f, 1e4f}) {
        control.motor.mode = MotorMode::ToVelocity;
        control.motor.targetSpeed = speed;
        float position = 0.0f;
        for (int i = 0; i < 200; ++i) {
            auto rows = RowsAt(control, position);
            const float now = rows[kMotor].speed;
            // Where it can get there within the step, the limit watches.
            if (position + now * kDt > 0.9999f) {
                EXPECT_TRUE(rows.contains(kHigh));
            }
            position += now * kDt;
            ASSERT_LE(position, 1.0f + 1e-6f);
        }
        EXPECT_NEAR(position, 1.0f, 1e-6f);
        EXPECT_NEAR(RowsAt(control, position)[kMotor].speed, 0.0f, 1e-4f);
    }
}

TEST(AxisControl, BeyondAHardLimitAMotorDoesNotPushOn) {
    AxisControl control = Limited(-1, 1);
    control.motor.mode = MotorMode::ToVelocity;
    control.motor.targetSpeed = 5.0f;
    const JointRow row = RowsAt(control, 1.1f)[kMotor];
    EXPECT_LE(row.speed, 0.0f);
    EXPECT_EQ(row.maxForce, 0.0f);
    // A soft limit may be overrun.
    control.limits.spring.frequency = 2.0f;
    EXPECT_EQ(RowsAt(control, 1.1f)[kMotor].speed, 5.0f);
}

TEST(AxisControl, AStiffPositionMotorKeepsTheLimitRowBehindItsTarget) {
    AxisControl control = Limited(-1, 1);
    control.motor.mode = MotorMode::ToPosition;
    control.motor.targetPosition = 0.8f;
    control.motor.spring = {.frequency = 30.0f, .dampingRatio = 0.1f};
    EXPECT_TRUE(RowsAt(control, 0.0f).contains(kHigh));
    EXPECT_FALSE(RowsAt(control, 0.0f).contains(kLow));
    control.motor.spring.frequency = 0.5f;
    EXPECT_FALSE(RowsAt(control, 0.0f).contains(kHigh));
}

TEST(AxisControl, FrictionHoldsBothWays) {
    AxisControl control;
    control.friction = 7.0f;
    const JointRow row = RowsAt(control, 0.5f, 3.0f)[kFriction];
    EXPECT_EQ(row.kind, Kind::Speed);
    EXPECT_EQ(row.speed, 0.0f);
    EXPECT_EQ(row.minForce, -7.0f);
    EXPECT_EQ(row.maxForce, 7.0f);
}

}  // namespace
}  // namespace fulcrum::testing
