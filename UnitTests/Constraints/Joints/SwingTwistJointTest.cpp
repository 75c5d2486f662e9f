// Swing-twist and six-degrees-of-freedom joints: blocks, limits, motors and friction of rotations about three axes.
#include "JointCases.h"

#include <Fulcrum/Physics/Joints/SixDofJoint.h>
#include <Fulcrum/Physics/Joints/SwingTwistJoint.h>

namespace fulcrum::testing {
namespace {

constexpr float kPi = 3.14159265f;
using Kind = JointRow::Kind;

int SlotOf(const JointType& type, JointAxis axis, uint32_t row) { return static_cast<int>(type.FirstSlot(axis) + row); }

TEST(SwingTwistJoint, FreeAxesHaveNoRows) {
    SwingTwistJoint joint({}, {}, {}, SwingShape::Ellipse);
    EXPECT_EQ(joint.Locks(), (JointLocks{LinearLock::Point, AngularLock::None, 0, 0}));
    EXPECT_EQ(joint.MaxRows(), 0u);
}

TEST(SwingTwistJoint, LockedAxesBecomeBlocks) {
    const AxisControl locked = Limited(0, 0), free;
    const auto locksOf = [](const AxisControl& x, const AxisControl& y, const AxisControl& z) {
        return SwingTwistJoint(x, y, z, SwingShape::Pyramid).Locks();
    };
    EXPECT_EQ(locksOf(locked, locked, locked), (JointLocks{LinearLock::Point, AngularLock::All, 0, 0}));
    EXPECT_EQ(locksOf(free, locked, locked), (JointLocks{LinearLock::Point, AngularLock::Axis, 0, 0}));
    EXPECT_EQ(locksOf(locked, free, locked), (JointLocks{LinearLock::Point, AngularLock::Axis, 0, 1}));
    EXPECT_EQ(locksOf(locked, locked, free), (JointLocks{LinearLock::Point, AngularLock::Axis, 0, 2}));
    EXPECT_EQ(locksOf(locked, free, free), (JointLocks{LinearLock::Point, AngularLock::None, 0, 0}));
    AxisControl soft = locked;
    soft.limits.spring.frequency = 5.0f;
    EXPECT_EQ(locksOf(free, soft, locked), (JointLocks{LinearLock::Point, AngularLock::None, 0, 0}));
}

TEST(SwingTwistJoint, WithOneFreeAxisItIsAHingeThatCountsTurns) {
    const AxisControl locked = Limited(0, 0);
    for (int axis = 0; axis < 3; ++axis) {
        std::array<AxisControl, 3> axes = {locked, locked, locked};
        axes[static_cast<size_t>(axis)] = Driven(MotorMode::ToPosition, 1.0f);
        SwingTwistJoint joint(axes[0], axes[1], axes[2], SwingShape::Ellipse);
        JointBodies bodies;
        const auto name = static_cast<JointAxis>(3 + axis);
        Vector3 about = Vector3::Zero();
        about[axis] = 1.0f;
        joint.Start(bodies.Pose());
        for (int i = 1; i <= 100; ++i) {
            bodies.PlaceB(Vector3::Zero(), About(about, 0.1f * static_cast<float>(i)));
            auto rows = RowsOf(joint, bodies.Pose());
            ASSERT_EQ(rows.size(), 1u);
            EXPECT_NEAR(rows[SlotOf(joint, name, ControlSlots::kMotor)].error, 0.1f * static_cast<float>(i) - 1.0f,
                        1e-5f);
        }
        EXPECT_NEAR(joint.Coordinate(name, bodies.Pose()), 10.0, 1e-5);
    }
}

TEST(SwingTwistJoint, LimitRowsAreTheDerivativesOfTheWayToTheEdge) {
    // Every row is there: flat edges are reached by the speed; curved ones, which are seen from where the swing goes,
    // are near. Edges bend; and the twist's J is exact at its limit only, off by half of the way to it.
    RandomPoses random(11);
    for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid})
        for (int i = 0; i < 30; ++i) {
            JointBodies bodies = JointBodies::AtRandom(random);
            const bool curved = shape == SwingShape::Ellipse;
            const float edge = 0.8f + random.Between(curved ? -0.02f : -0.05f, 0.15f),
                        side = random.Between(-0.3f, 0.3f);
            bodies.PlaceB(Vector3::Zero(), RotationFromVector(Vector3(0, edge, side)));
            if (!curved) bodies.velocity[1].angular = Vector3(40, 40, 40);
            const SwingTwistJoint joint(Limited(-0.004f, 0.004f), Limited(-0.8f, 0.8f), Limited(-1.2f, 1.2f), shape);
            ExpectJacobiansOf(joint, bodies, 5e-3f);
        }
}

// The axis turns with both bodies, so that the error is right where the swing goes: on a circle, and nearly on an
// ellipse.
TEST(SwingTwistJoint, ACurvedEdgeIsRightWhereTheSwingGoes) {
    for (const float wide : {0.8f, 1.2f}) {
        SwingTwistJoint joint({}, Limited(-0.8f, 0.8f), Limited(-wide, wide), SwingShape::Ellipse);
        JointBodies bodies;
        bodies.PlaceB(Vector3::Zero(), RotationFromVector(Vector3(0, 0.5f, -0.4f)));
        const Vector3 way(0, 0.15f, -0.35f);
        bodies.velocity[1].angular = way * (1 / bodies.Pose().dt);
        auto rows = RowsOf(joint, bodies.Pose());
        ASSERT_EQ(rows.size(), 1u);
        const auto [slot, row] = *rows.begin();
        ASSERT_EQ(row.pivot, JointRow::Pivot::Across);
        const Vector3 before = row.jacobian.b.angular;
        EXPECT_NEAR(
            Length(before - Normalized(Cross(row.ofA, row.ofB))) * Length(before + Normalized(Cross(row.ofA, row.ofB))),
            0, 1e-5f);
        Vector3 axis = Normalized(Cross(row.ofA, Rotate(RotationFromVector(way), row.ofB)));
        if (Dot(axis, before) < 0) axis = -axis;
        // There, at rest.
        bodies.velocity[1].angular = Vector3::Zero();
        bodies.Move(1, {Vector3::Zero(), way});
        auto there = RowsOf(joint, bodies.Pose());
        ASSERT_TRUE(there.contains(slot));
        EXPECT_NEAR(row.error + 0.5f * Dot(Vector3(before + axis), way), there[slot].error, wide > 1 ? 0.02f : 3e-3f);
        EXPECT_GT(Dot(axis, there[slot].jacobian.b.angular), wide > 1 ? 0.98f : 0.9999f);
    }
}

TEST(SwingTwistJoint, LimitsHaveRowsOnlyNearby) {
    for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid}) {
        SwingTwistJoint joint(Limited(-0.5f, 0.5f), Limited(-0.8f, 0.8f), Limited(-1.2f, 1.2f), shape);
        const auto rowsAt = [&](const Vector3& swing, float twist) {
            JointBodies bodies;
            bodies.PlaceB(Vector3::Zero(), RotationFromVector(swing) * AboutX(twist));
            return RowsOf(joint, bodies.Pose());
        };
        EXPECT_TRUE(rowsAt(Vector3(0, 0.5f, 0), 0.4f).empty());
        auto rows = rowsAt(Vector3(0, 0.79f, 0), 0.0f);
        ASSERT_EQ(rows.size(), 1u);
        const JointRow& swing = rows[SlotOf(joint, JointAxis::AngularY, ControlSlots::kHighLimit)];
        EXPECT_EQ(swing.kind, Kind::AtLeast);
        EXPECT_NEAR(swing.error, 0.01f, 1e-5f);
        rows = rowsAt(Vector3(0, 0, 0), -0.51f);
        ASSERT_EQ(rows.size(), 1u);
        EXPECT_NEAR(rows[SlotOf(joint, JointAxis::AngularX, ControlSlots::kLowLimit)].error, -0.01f, 1e-5f);
    }
}

TEST(SwingTwistJoint, ComesBackFromTheOppositeSide) {
    SwingTwistJoint joint(Limited(-0.5f, 0.5f), Limited(-0.8f, 0.8f), Limited(-0.8f, 0.8f), SwingShape::Ellipse);
    JointBodies bodies;
    bodies.PlaceB(Vector3::Zero(), {0, 1, 0, 0});
    auto rows = RowsOf(joint, bodies.Pose());
    const JointRow& row = rows[SlotOf(joint, JointAxis::AngularY, ControlSlots::kHighLimit)];
    EXPECT_NEAR(row.error, 0.8f - kPi, 1e-5f);
    EXPECT_NEAR(row.jacobian.b.angular.norm(), 1.0f, 1e-5f);
}

TEST(SwingTwistJoint, PositionMotorsTurnToTheTargetTheShortestWay) {
    RandomPoses random(12);
    AxisControl motor = Driven(MotorMode::ToPosition, 0.0f);
    for (int i = 0; i < 30; ++i) {
        SwingTwistJoint joint(motor, motor, motor, SwingShape::Ellipse);
        const Quaternion target = RandomRotation(random);
        joint.SetTargetOrientation(target);
        const Vector3 axis = AnyDirection(random), off = axis * random.Between(0.01f, 3.0f);
        JointBodies bodies = JointBodies::AtRandom(random);
        bodies.PlaceB(Vector3::Zero(), target * RotationFromVector(off));
        auto rows = RowsOf(joint, bodies.Pose());
        // The torque of springs of equal strength is along -sum of C times axis: in B's frame -off.
        Vector3 way = Vector3::Zero();
        for (int k = 0; k < 3; ++k) {
            const JointRow& row = rows[SlotOf(joint, static_cast<JointAxis>(3 + k), ControlSlots::kMotor)];
            EXPECT_EQ(row.kind, Kind::Spring);
            way += row.jacobian.b.angular * row.error;
        }
        EXPECT_LT((InverseRotate(bodies.FrameOf(1), way) - off).norm(), 1e-5f);
    }
}

TEST(SwingTwistJoint, MotorRowsAreTheDerivativesOfTheErrorNearTheTarget) {
    // To first order in the error, which is 0.01: its half is what J leaves out.
    RandomPoses random(13);
    AxisControl motor = Driven(MotorMode::ToPosition, 0.0f);
    for (int i = 0; i < 10; ++i) {
        SwingTwistJoint joint(motor, motor, motor, SwingShape::Ellipse);
        const Quaternion target = RandomRotation(random);
        joint.SetTargetOrientation(target);
        JointBodies bodies = JointBodies::AtRandom(random);
        bodies.PlaceB(Vector3::Zero(), target * RotationFromVector(Vector3(AnyDirection(random) * 0.01f)));
        ExpectJacobiansOf(joint, bodies, 8e-3f);
    }
}

TEST(SwingTwistJoint, TargetsAreKeptWithinTheLimits) {
    // Motor and limit then agree: at the nearest allowed orientation the motors are content.
    for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid}) {
        AxisControl twist = Limited(-0.5f, 0.5f), swing = Limited(-0.8f, 0.8f);
        twist.motor.mode = swing.motor.mode = MotorMode::ToPosition;
        SwingTwistJoint joint(twist, swing, swing, shape);
        joint.SetTargetOrientation(AboutZ(1.5f) * AboutX(-1.0f));
        JointBodies bodies;
        bodies.PlaceB(Vector3::Zero(), AboutZ(0.8f) * AboutX(-0.5f));
        auto rows = RowsOf(joint, bodies.Pose());
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(rows[SlotOf(joint, static_cast<JointAxis>(3 + k), ControlSlots::kMotor)].error, 0.0f, 1e-6f);
    }
}

TEST(SwingTwistJoint, AVelocityMotorComesToAHardLimitButNotBeyond) {
    AxisControl swing = Limited(-0.8f, 0.8f);
    swing.motor.mode = MotorMode::ToVelocity;
    swing.motor.targetSpeed = 100.0f;
    SwingTwistJoint joint(Limited(-0.5f, 0.5f), swing, Limited(-0.8f, 0.8f), SwingShape::Ellipse);
    JointBodies bodies;
    float angle = 0.0f;
    for (int i = 0; i < 10; ++i) {
        bodies.PlaceB(Vector3::Zero(), AboutY(angle));
        auto rows = RowsOf(joint, bodies.Pose());
        angle += rows[SlotOf(joint, JointAxis::AngularY, ControlSlots::kMotor)].speed * bodies.dt;
        EXPECT_TRUE(rows.contains(SlotOf(joint, JointAxis::AngularY, ControlSlots::kHighLimit)));
        EXPECT_LT(angle, 0.8f + 1e-6f);
    }
    EXPECT_NEAR(angle, 0.8f, 1e-5f);
    bodies.PlaceB(Vector3::Zero(), AboutY(0.9f));
    EXPECT_EQ(RowsOf(joint, bodies.Pose())[SlotOf(joint, JointAxis::AngularY, ControlSlots::kMotor)].maxForce, 0.0f);
}

TEST(SwingTwistJoint, FrictionIsAboutTheAxesOfB) {
    AxisControl rough;
    rough.friction = 3.0f;
    SwingTwistJoint joint(rough, {}, rough, SwingShape::Ellipse);
    JointBodies bodies;
    bodies.PlaceB(Vector3::Zero(), AboutY(1.0f));
    auto rows = RowsOf(joint, bodies.Pose());
    ASSERT_EQ(rows.size(), 2u);
    const JointRow& row = rows[SlotOf(joint, JointAxis::AngularX, ControlSlots::kFriction)];
    EXPECT_EQ(row.maxForce, 3.0f);
    EXPECT_LT((row.jacobian.b.angular - ToMatrix(bodies.FrameOf(1)).x).norm(), 1e-6f);
}

TEST(SixDofJoint, LockedTranslationsBecomeBlocks) {
    const AxisControl locked = Limited(0, 0), free;
    const auto locksOf = [&](const AxisControl& x, const AxisControl& y, const AxisControl& z) {
        return SixDofJoint({x, y, z, free, free, free}, SwingShape::Pyramid).Locks();
    };
    EXPECT_EQ(locksOf(locked, locked, locked).linear, LinearLock::Point);
    EXPECT_EQ(locksOf(locked, free, locked), (JointLocks{LinearLock::Line, AngularLock::None, 1, 0}));
    EXPECT_EQ(locksOf(locked, locked, Limited(-1, 1)), (JointLocks{LinearLock::Line, AngularLock::None, 2, 0}));
    EXPECT_EQ(locksOf(locked, free, free).linear, LinearLock::None);
    EXPECT_EQ(locksOf(Limited(1, 1), locked, locked), (JointLocks{LinearLock::Line, AngularLock::None, 0, 0}));
}

TEST(SixDofJoint, SingleLockedAxesAreRows) {
    const AxisControl locked = Limited(0, 0), free;
    SixDofJoint joint({locked, free, free, free, locked, free}, SwingShape::Pyramid);
    EXPECT_EQ(joint.Locks(), (JointLocks{LinearLock::None, AngularLock::None, 0, 0}));
    EXPECT_EQ(joint.MaxRows(), 2u);
    RandomPoses random(14);
    for (int i = 0; i < 30; ++i) {
        JointBodies bodies = JointBodies::AtRandom(random);
        const Vector3 place = random.InBox(1.0f);
        const float z = random.Between(-1, 1), x = random.Between(-1, 1);
        bodies.PlaceB(place, AboutZ(z) * AboutY(0.2f) * AboutX(x));
        JointBodies at = bodies;
        SixDofJoint copy = joint;
        auto rows = RowsOf(copy, at.Pose());
        ASSERT_EQ(rows.size(), 2u);
        EXPECT_EQ(rows[SlotOf(joint, JointAxis::LinearX, 0)].kind, Kind::Equal);
        EXPECT_EQ(rows[SlotOf(joint, JointAxis::AngularY, ControlSlots::kHighLimit)].kind, Kind::Equal);
        ExpectJacobiansOf(joint, bodies, 2e-3f);
    }
}

TEST(SixDofJoint, EverythingAtOnceFitsItsSlots) {
    AxisControl all = Limited(-0.001f, 0.001f);
    all.motor.mode = MotorMode::ToVelocity;
    all.friction = 1.0f;
    SixDofJoint joint({all, all, all, all, all, all}, SwingShape::Pyramid);
    EXPECT_EQ(joint.MaxRows(), JointRowList::kMaxRows);
    EXPECT_EQ(RowsOf(joint, JointBodies().Pose()).size(), JointRowList::kMaxRows);
}

TEST(SixDofJoint, LinearRowsAreTheDerivativesOfTheWay) {
    RandomPoses random(15);
    const AxisControl motor = Driven(MotorMode::ToPosition, 0.3f);
    for (int i = 0; i < 10; ++i) {
        const JointBodies bodies = JointBodies::AtRandom(random);
        ExpectJacobiansOf(SixDofJoint({motor, motor, motor, {}, {}, {}}, SwingShape::Pyramid), bodies, 2e-3f);
    }
}

}  // namespace
}  // namespace fulcrum::testing
