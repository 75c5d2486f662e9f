// The rows of each type of joint: C and Jacobian at random poses, which rows there are and when, angles over many
// turns.
#include "JointCases.h"

#include <Fulcrum/Physics/Joints/JointKinds.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr float kPi = 3.14159265f;
constexpr int kPoses = 30;
constexpr int kLow = ControlSlots::kLowLimit, kHigh = ControlSlots::kHighLimit, kMotor = ControlSlots::kMotor;

TEST(FixedJoint, HasLocksAndNoRows) {
    FixedJoint joint;
    EXPECT_EQ(joint.Locks(), (JointLocks{.linear = LinearLock::Point, .angular = AngularLock::All}));
    EXPECT_EQ(joint.MaxRows(), 0u);
    EXPECT_EQ(joint.Control(JointAxis::AngularX), nullptr);
}

TEST(DistanceJoint, RowsAreTheDerivativeOfTheDistance) {
    RandomPoses random(1);
    for (int i = 0; i < kPoses; ++i) {
        const JointBodies bodies = JointBodies::AtRandom(random);
        const DistanceJoint joint(0.7f, 0.7f, {});
        DistanceJoint copy = joint;
        EXPECT_NEAR(RowsOf(copy, bodies.Pose())[kLow].error, Length(bodies.Pose().offset) - 0.7f, 1e-5f);
        ExpectJacobiansOf(joint, bodies, 3e-3f);
    }
}

TEST(DistanceJoint, KeepsThePresentDistanceUnlessToldOtherwise) {
    JointBodies bodies;
    bodies.place[1] = Position(0, 3, 4);
    DistanceJoint rod(std::nullopt, std::nullopt, {}), rope(std::nullopt, 6.0f, {}), strut(2.0f, std::nullopt, {});
    for (DistanceJoint* joint : {&rod, &rope, &strut}) joint->Start(bodies.Pose());
    EXPECT_EQ(RowsOf(rod, bodies.Pose())[kLow].kind, JointRow::Kind::Equal);
    EXPECT_NEAR(RowsOf(rod, bodies.Pose())[kLow].error, 0.0f, 1e-6f);
    EXPECT_TRUE(RowsOf(rope, bodies.Pose()).empty());
    EXPECT_TRUE(RowsOf(strut, bodies.Pose()).empty());
    EXPECT_NEAR(rod.Coordinate(JointAxis::LinearX, bodies.Pose()), 5.0, 1e-6);
    bodies.place[1] = Position(0, 3, 5.5);
    EXPECT_NEAR(RowsOf(rope, bodies.Pose())[kHigh].error, 6.0f - std::sqrt(39.25f), 1e-5f);
}

TEST(DistanceJoint, IsSafeWhereThePointsCoincide) {
    JointBodies bodies;
    DistanceJoint joint(1.0f, 1.0f, {});
    const JointRow row = RowsOf(joint, bodies.Pose())[kLow];
    EXPECT_EQ(row.error, -1.0f);
    EXPECT_EQ(row.jacobian.b.linear, Vector3(1, 0, 0));
}

TEST(DistanceJoint, ARopeThatSwingsFastIsCaughtInTime) {
    JointBodies bodies;
    bodies.place[1] = Position(0.97, 0, 0);
    DistanceJoint rope(0.0f, 1.0f, {});
    EXPECT_TRUE(RowsOf(rope, bodies.Pose()).empty());
    bodies.velocity[1].linear = Vector3(0, 20, 0);  // in a step to 1.026 m
    EXPECT_TRUE(RowsOf(rope, bodies.Pose()).contains(kHigh));
}

TEST(HingeJoint, RowsAreTheDerivativeOfTheAngle) {
    RandomPoses random(2);
    for (int i = 0; i < kPoses; ++i) {
        JointBodies bodies = JointBodies::AtRandom(random);
        const float angle = random.Between(-3.0f, 3.0f);
        bodies.PlaceB(Vector3::Zero(), AboutX(angle));
        HingeJoint joint(Driven(MotorMode::ToPosition, 0.5f));
        joint.Start(bodies.Pose());
        HingeJoint copy = joint;
        EXPECT_NEAR(RowsOf(copy, bodies.Pose())[kMotor].error, angle - 0.5f, 1e-5f);
        EXPECT_NEAR(joint.Coordinate(JointAxis::AngularX, bodies.Pose()), static_cast<double>(angle), 1e-5);
        ExpectJacobiansOf(joint, bodies);
    }
}

TEST(HingeJoint, CountsAHundredThousandTurnsAtAnySpeed) {
    // Frames that are not the bodies', so that products of rotations round; half a turn a step is 188 rad/s, so that
    // only the way of the step tells the turn. The angle is known to some units of 1e-7, however many turns there were.
    RandomPoses random(3);
    JointBodies bodies = JointBodies::AtRandom(random);
    HingeJoint joint(Driven(MotorMode::ToPosition, 0.0f));
    bodies.PlaceB(Vector3::Zero(), {});
    joint.Start(bodies.Pose());
    double angle = 0.0, speed = 0.0;
    const auto turnTo = [&](double end, double acceleration) {
        while (acceleration > 0.0 ? angle < end : angle > end) {
            const double before = speed;
            speed = std::clamp(speed + acceleration, -1000.0, 1000.0);
            const double way = 0.5 * (before + speed) * static_cast<double>(bodies.dt);
            angle += way;
            bodies.PlaceB(Vector3::Zero(), AboutX(static_cast<float>(NearestTurn(angle, 0.0))));
            bodies.turned[1] = ToMatrix(bodies.FrameOf(0)).x * static_cast<float>(way);
            EXPECT_NEAR(joint.Coordinate(JointAxis::AngularX, bodies.Pose()), angle, 2e-6);
            JointRowList rows;
            joint.CollectRows(bodies.Pose(), rows);
        }
    };
    turnTo(1e5 * kFullTurn, 80.0);
    turnTo(0.0, -80.0);
}

TEST(HingeJoint, StartsInTheTurnOfItsLimits) {
    JointBodies bodies;
    const auto startAt = [&](float angle, float min, float max) {
        bodies.PlaceB(Vector3::Zero(), AboutX(angle));
        HingeJoint joint(Limited(min, max));
        joint.Start(bodies.Pose());
        return joint.Coordinate(JointAxis::AngularX, bodies.Pose());
    };
    EXPECT_NEAR(startAt(0.5f, -1.0f, 1.0f), 0.5, 1e-6);
    EXPECT_NEAR(startAt(-0.5f, 0.0f, 6.0f), kFullTurn - 0.5, 1e-6);
    EXPECT_NEAR(startAt(1.0f, -40.0f, -30.0f), 1.0 - 6 * kFullTurn, 1e-5);
    EXPECT_NEAR(startAt(3.0f, -1.0f, 0.5f), 3.0 - kFullTurn, 1e-6);  // 2.28 short of it, in place of 2.5 beyond
}

TEST(HingeJoint, LimitsAtHalfATurnStopThere) {
    JointBodies bodies;
    HingeJoint joint(Limited(-kPi, kPi));
    for (const float angle : {3.0f, 3.1f, 3.2f}) {  // across the seam of the angle
        bodies.PlaceB(Vector3::Zero(), AboutX(angle));
        bodies.velocity[1].angular = Vector3(6, 0, 0);
        auto rows = RowsOf(joint, bodies.Pose());
        ASSERT_TRUE(rows.contains(kHigh)) << angle;
        EXPECT_NEAR(rows[kHigh].error, kPi - angle, 2e-6f);
    }
}

TEST(SliderJoint, RowsAreTheDerivativeOfTheWay) {
    RandomPoses random(4);
    for (int i = 0; i < kPoses; ++i) {
        JointBodies bodies = JointBodies::AtRandom(random);
        const float way = random.Between(-2.0f, 2.0f);
        bodies.PlaceB(Vector3(way, 0, 0), {});
        const SliderJoint joint(Driven(MotorMode::ToPosition, 0.5f));
        SliderJoint copy = joint;
        EXPECT_NEAR(RowsOf(copy, bodies.Pose())[kMotor].error, way - 0.5f, 1e-5f);
        ExpectJacobiansOf(joint, bodies);
    }
}

TEST(ConeJoint, RowsAreTheDerivativeOfTheAngleBetweenTheAxes) {
    RandomPoses random(5);
    for (int i = 0; i < kPoses; ++i) {
        JointBodies bodies = JointBodies::AtRandom(random);
        const float angle = random.Between(0.2f, 2.9f), before = random.Between(-3, 3), after = random.Between(-3, 3);
        bodies.PlaceB(Vector3::Zero(), AboutX(before) * AboutY(angle) * AboutX(after));
        const ConeJoint joint(0.1f, {});
        ConeJoint copy = joint;
        EXPECT_NEAR(RowsOf(copy, bodies.Pose())[kHigh].error, 0.1f - angle, 1e-5f);
        ExpectJacobiansOf(joint, bodies);
    }
}

TEST(ConeJoint, OfNoAngleIsAnAxleAndOfHalfATurnNoLimit) {
    const ConeJoint axle(0.0f, {}), ball(kPi, {}), cone(1.0f, {});
    EXPECT_EQ(axle.Locks(), (JointLocks{LinearLock::Point, AngularLock::Axis, 0, 0}));
    EXPECT_EQ(axle.MaxRows(), 0u);
    EXPECT_EQ(ball.Locks(), (JointLocks{LinearLock::Point, AngularLock::None, 0, 0}));
    EXPECT_EQ(ball.MaxRows(), 0u);
    EXPECT_EQ(cone.MaxRows(), 2u);
}

TEST(ConeJoint, HasOneRowNearItsLimitAndAWayBackFromTheOppositeSide) {
    JointBodies bodies;
    ConeJoint joint(1.0f, {});
    EXPECT_TRUE(RowsOf(joint, bodies.Pose()).empty());
    bodies.PlaceB(Vector3::Zero(), AboutZ(0.99f));
    auto rows = RowsOf(joint, bodies.Pose());
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_NEAR(rows[kHigh].error, 0.01f, 1e-6f);
    EXPECT_LT((rows[kHigh].jacobian.b.angular - Vector3(0, 0, -1)).norm(), 1e-6f);
    bodies.PlaceB(Vector3::Zero(), {0, 1, 0, 0});
    rows = RowsOf(joint, bodies.Pose());
    EXPECT_NEAR(rows[kHigh].error, 1.0f - kPi, 1e-6f);
    EXPECT_NEAR(rows[kHigh].jacobian.b.angular.norm(), 1.0f, 1e-6f);
    EXPECT_NEAR(rows[kHigh].jacobian.b.angular.x(), 0.0f, 1e-6f);
}

TEST(GearJoint, RowIsTheDerivativeOfThePhase) {
    RandomPoses random(6);
    for (int i = 0; i < kPoses; ++i) {
        const JointBodies bodies = JointBodies::AtRandom(random);
        GearJoint joint(random.Between(-3.0f, 3.0f));
        joint.Start(bodies.Pose());
        ExpectJacobiansOf(joint, bodies);
    }
}

TEST(GearJoint, LosesNoTeethOverAHundredThousandTurns) {
    // A turns 1e5 times against B, a wheel of ratio 2.5. The angles round to 4e-7 rad, times the ratio.
    RandomPoses random(7);
    JointBodies bodies = JointBodies::AtRandom(random);
    const Quaternion start[2] = {bodies.FrameOf(0), bodies.FrameOf(1)};
    GearJoint joint(2.5f);
    joint.Start(bodies.Pose());
    constexpr double kSpeed = 1000.0;
    float worst = 0.0f;
    double angle = 0.0;
    while (angle < 1e5 * kFullTurn) {
        angle += kSpeed * static_cast<double>(bodies.dt);
        const double angles[2] = {angle, -angle / 2.5}, speeds[2] = {kSpeed, -kSpeed / 2.5};
        for (int i = 0; i < 2; ++i) {
            const Quaternion frame = start[i] * AboutX(static_cast<float>(NearestTurn(angles[i], 0.0)));
            bodies.rotation[i] = Normalized(frame * bodies.frame[i].Conjugate());
            bodies.turned[i] = ToMatrix(bodies.FrameOf(i)).x * (static_cast<float>(speeds[i]) * bodies.dt);
        }
        JointRowList rows;
        joint.CollectRows(bodies.Pose(), rows);
        worst = std::max(worst, std::fabs(rows.rows[0].error));
    }
    EXPECT_LT(worst, 5e-6f);
}

TEST(GearJoint, CarryingTheAxesAboutAddsNoTurn) {
    // The axes lean to and fro by half a turn in all, about an axis perpendicular to them, which turns neither gear. Of
    // the references that follow each rounds by some 1e-7.
    JointBodies bodies;
    GearJoint joint(1.0f);
    joint.Start(bodies.Pose());
    for (int i = 0; i <= 400; ++i) {
        const float lean = 1.5f * std::sin(0.0157079633f * static_cast<float>(i));
        bodies.rotation[0] = AboutZ(lean) * AboutX(0.3f);
        bodies.rotation[1] = AboutZ(lean);
        JointRowList rows;
        joint.CollectRows(bodies.Pose(), rows);
        ASSERT_NEAR(rows.rows[0].error, 0.3f, 2e-5f);
    }
}

TEST(RackAndPinionJoint, RowIsTheDerivativeOfThePhase) {
    RandomPoses random(8);
    for (int i = 0; i < kPoses; ++i) {
        const JointBodies bodies = JointBodies::AtRandom(random);
        RackAndPinionJoint joint(random.Between(0.5f, 4.0f));
        joint.Start(bodies.Pose());
        ExpectJacobiansOf(joint, bodies, 3e-3f);
    }
}

TEST(RackAndPinionJoint, RollsWithoutSlipping) {
    // A pinion of radius 0.25 m about z: 4 rad a meter.
    JointBodies bodies;
    bodies.frame[0] = AboutY(-0.5f * kPi);  // its x is z of the body
    bodies.anchor[1] = Vector3(0, 0.25f, 0);
    RackAndPinionJoint joint(4.0f);
    joint.Start(bodies.Pose());
    bodies.rotation[0] = AboutZ(2.0f);
    bodies.place[1] = Position(0.5, 0, 0);
    EXPECT_NEAR(RowsOf(joint, bodies.Pose())[0].error, 0.0f, 1e-6f);
    bodies.place[1] = Position(0.4, 0, 0);
    EXPECT_NEAR(RowsOf(joint, bodies.Pose())[0].error, 0.4f, 1e-6f);
}

TEST(PulleyJoint, RowsAreTheDerivativeOfTheLength) {
    RandomPoses random(9);
    for (int i = 0; i < kPoses; ++i) {
        const JointBodies bodies = JointBodies::AtRandom(random);
        const float ratio = random.Between(0.5f, 3.0f);
        const PulleyJoint joint(Position(-2, 8, 0), Position(2, 8, 0), ratio, 1.0f, 1.0f);
        PulleyJoint copy = joint;
        const double length = (bodies.AnchorOf(0) - Position(-2, 8, 0)).norm() +
                              static_cast<double>(ratio) * (bodies.AnchorOf(1) - Position(2, 8, 0)).norm();
        EXPECT_NEAR(static_cast<double>(RowsOf(copy, bodies.Pose())[kLow].error), length - 1.0, 1e-5);
        ExpectJacobiansOf(joint, bodies, 3e-3f);
    }
}

TEST(PulleyJoint, IsTautAtTheLengthItBeganWith) {
    JointBodies bodies;
    bodies.place[0] = Position(-1, 0, 0);
    bodies.place[1] = Position(1, 1, 0);
    PulleyJoint joint(Position(-1, 4, 0), Position(1, 4, 0), 2.0f, 0.0f, std::nullopt);
    joint.Start(bodies.Pose());
    EXPECT_NEAR(joint.Coordinate(JointAxis::LinearX, bodies.Pose()), 10.0, 1e-6);
    auto rows = RowsOf(joint, bodies.Pose());
    ASSERT_EQ(rows.size(), 1u);
    EXPECT_EQ(rows[kHigh].kind, JointRow::Kind::AtLeast);
    EXPECT_NEAR(rows[kHigh].error, 0.0f, 1e-6f);
    bodies.place[0].y() = 1.0;  // slack
    EXPECT_TRUE(RowsOf(joint, bodies.Pose()).empty());
    bodies.place[0] = Position(-1, 4, 0);  // drawn up to the wheel, where it pulls A nowhere
    bodies.place[1].y() = -1.1;
    rows = RowsOf(joint, bodies.Pose());
    EXPECT_NEAR(rows[kHigh].error, -0.2f, 1e-5f);
    EXPECT_EQ(rows[kHigh].jacobian.a.linear, Vector3(0, 0, 0));
}

TEST(WheelJoint, RowsAreTheDerivativesOfItsAngles) {
    RandomPoses random(10);
    for (int i = 0; i < kPoses; ++i) {
        JointBodies bodies = JointBodies::AtRandom(random);
        const float steering = random.Between(-0.6f, 0.6f), tilt = random.Between(-0.3f, 0.3f),
                    spin = random.Between(-3, 3);
        bodies.PlaceB(Vector3(0, random.Between(-0.2f, 0.2f), 0), AboutY(steering) * AboutZ(tilt) * AboutX(spin));
        const AxisControl motor = Driven(MotorMode::ToPosition, 0.0f);
        WheelJoint joint(motor, true, motor, motor);
        joint.Start(bodies.Pose());
        EXPECT_NEAR(joint.Coordinate(JointAxis::AngularX, bodies.Pose()), static_cast<double>(spin), 1e-5);
        EXPECT_NEAR(joint.Coordinate(JointAxis::AngularY, bodies.Pose()), static_cast<double>(steering), 1e-5);
        EXPECT_NEAR(joint.Coordinate(JointAxis::AngularZ, bodies.Pose()), static_cast<double>(tilt), 1e-5);
        ExpectJacobiansOf(joint, bodies, 2e-3f);
    }
}

TEST(WheelJoint, WithoutSteeringItsAxleIsALock) {
    const WheelJoint fixed({}, false, {}, {}), steered({}, true, {}, {});
    EXPECT_EQ(fixed.Locks(), (JointLocks{LinearLock::Line, AngularLock::Axis, 1, 0}));
    EXPECT_EQ(fixed.MaxRows(), 0u);
    EXPECT_EQ(steered.Locks(), (JointLocks{LinearLock::Line, AngularLock::None, 1, 0}));
    EXPECT_EQ(steered.MaxRows(), 1u);
}

}  // namespace
}  // namespace fulcrum::testing
