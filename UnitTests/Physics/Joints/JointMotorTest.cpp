// Motors and friction of joints: forces, speeds and places that mechanics predicts.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A velocity goes through some ten roundings a substep.
double Rounding(double speed, int steps) { return speed * steps * 4 * 10 * std::exp2(-24); }

// A box that slides along x, or along y, and nothing pulls at it but what a test adds.
struct SliderRig {
    explicit SliderRig(double mass, const AxisControl& slide = {}, const SystemSettings& settings = NoGravity(),
                       const Vector3& axis = Vector3(1, 0, 0))
        : world(settings), box(world.Add({.shape = CubeOf(0.5f), .mass = static_cast<float>(mass)})) {
        joint = Join(world, SliderJointSettings{Between(AddHook(world), box, {0, 0, 0}, axis), slide});
    }
    JointInterface& Joints() { return JointsOf(world); }
    double Place() { return Joints().GetCoordinate(joint, JointAxis::LinearX); }
    double Speed() { return double(world.VelocityOf(box).x() + world.VelocityOf(box).y()); }
    JointAxisForces Forces() { return Joints().GetAxisForces(joint, JointAxis::LinearX); }

    TestWorld world;
    BodyId box;
    JointId joint;
};

// A rod of 1 x 0.1 x 0.1 m that turns about its end.
struct HingeRig {
    static constexpr double kUnitInertia = (1 + 0.01) / 12 + 0.25;  // m2

    explicit HingeRig(double mass, const AxisControl& angle = {}, const SystemSettings& settings = NoGravity())
        : world(settings),
          rod(world.Add(
              {.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = static_cast<float>(mass)})) {
        joint = Join(world, HingeJointSettings{Between(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}), angle});
    }
    JointInterface& Joints() { return JointsOf(world); }
    double Angle() { return Joints().GetCoordinate(joint, JointAxis::AngularX); }
    double Speed() { return double(world.Bodies().GetAngularVelocity(rod).z()); }
    JointAxisForces Forces() { return Joints().GetAxisForces(joint, JointAxis::AngularX); }

    TestWorld world;
    BodyId rod;
    JointId joint;
};

TEST(Motor, AForceLimitGivesForceOverMass) {
    SliderRig rig(8000, {.motor = SpeedMotor(3, 16000)});
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), 2, Rounding(2, 60));
    EXPECT_NEAR(rig.Forces().motor, 16000, 1);
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), 3, Rounding(3, 120));
    // 1.5 s of acceleration and half a second at 3 m/s; half a substep at the new speed is too much.
    EXPECT_NEAR(rig.Place(), 0.5 * 2 * 1.5 * 1.5 + 0.5 * 3, 3 * kStep / 4 / 2 + 1e-4);
    EXPECT_NEAR(rig.Forces().motor, 0, 1);
}

TEST(Motor, BackwardsAsForwards) {
    SliderRig rig(8000, {.motor = SpeedMotor(-3, 16000)});
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), -2, Rounding(2, 60));
    EXPECT_NEAR(rig.Forces().motor, -16000, 1);
}

TEST(Motor, OneThatMayOnlyPullDoesNotPush) {
    JointMotor motor = SpeedMotor(-1);
    motor.minForce = -10;
    motor.maxForce = 0;
    SliderRig rig(2, {.motor = motor});
    ASSERT_TRUE(rig.world.Bodies().SetVelocity(rig.box, {-4, 0, 0}, {0, 0, 0}));
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), -4, Rounding(4, 30));
    ASSERT_TRUE(rig.world.Bodies().SetVelocity(rig.box, {4, 0, 0}, {0, 0, 0}));
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), 4 - 5 * 0.5, Rounding(4, 30));
}

TEST(Motor, ASpeedIsReachedAtOnceAndHeldUnderALoad) {
    SliderRig rig(50, {.motor = SpeedMotor(1.5)}, NoSleep(), {0, 1, 0});
    for (int i = 0; i < 120; ++i) {
        rig.world.Step();
        ASSERT_NEAR(rig.Speed(), 1.5, 1e-4);
    }
    EXPECT_NEAR(rig.Place(), 1.5 * 2, 1e-3);
    EXPECT_NEAR(rig.Forces().motor, 50 * kGravity, 0.001 * 50 * kGravity);
}

TEST(Motor, OneTooWeakForItsLoadSlowsTheFall) {
    SliderRig rig(10, {.motor = SpeedMotor(1, 10 * (kGravity - 2))}, NoSleep(), {0, 1, 0});
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), -2, 1e-4);
}

TEST(Motor, ATorqueLimitGivesTorqueOverTheInertiaAboutTheHinge) {
    HingeRig rig(3, {.motor = SpeedMotor(5, 2)});
    rig.world.Run(1);
    const double inertia = 3 * HingeRig::kUnitInertia;
    // The arc: 1e-3 covers what the substeps of a turning frame are off by.
    EXPECT_NEAR(rig.Speed(), 2 / inertia, 2e-3 * 2 / inertia);
    EXPECT_NEAR(rig.Angle(), 0.5 * 2 / inertia, 5e-3 * 0.5 * 2 / inertia);
    EXPECT_NEAR(rig.Forces().motor, 2, 1e-3);
}

TEST(Motor, AHingeHoldsItsSpeedWhileGravityTurnsAround) {
    HingeRig rig(3, {.motor = SpeedMotor(4)}, NoSleep());
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        rig.world.Step();
        // The jerk of the start dies away within three steps.
        if (i > 3) worst = std::max(worst, std::fabs(rig.Speed() - 4));
        // m g l cos(angle), on average over the step: the angle is that of its middle.
        const double angle = rig.Angle() - 4 * kStep / 2, torque = 3 * kGravity * 0.5 * std::cos(angle);
        if (i > 60) {
            ASSERT_NEAR(rig.Forces().motor, torque, 0.02 * 3 * kGravity * 0.5) << "step " << i;
        }
    }
    EXPECT_LT(worst, 0.02);
    EXPECT_NEAR(rig.Angle(), 40, 0.02);
}

TEST(Motor, APositionIsHeldWithTheErrorThatStiffnessPredicts) {
    const double stiffness = 2000;
    SliderRig rig(10, {.motor = PositionMotor(0.7, StiffnessSpring(stiffness, 200))}, NoSleep(), {0, 1, 0});
    rig.world.Run(6);
    EXPECT_NEAR(rig.Place(), 0.7 - 10 * kGravity / stiffness, 1e-4);
    EXPECT_NEAR(rig.Forces().motor, 10 * kGravity, 0.02);
}

TEST(Motor, AnAngleIsHeldWithTheErrorThatStiffnessPredicts) {
    const double stiffness = 300;
    HingeRig rig(3, {.motor = PositionMotor(0.5, StiffnessSpring(stiffness, 60))}, NoSleep());
    rig.world.Run(6);
    // k (target - angle) = m g l cos(angle).
    const double angle = rig.Angle();
    EXPECT_NEAR(stiffness * (0.5 - angle), 3 * kGravity * 0.5 * std::cos(angle), 0.005 * 3 * kGravity * 0.5);
    EXPECT_LT(angle, 0.48);
}

TEST(Motor, APositionMotorWithoutASpringHoldsItsTargetUnderALoad) {
    SliderRig rig(10, {.motor = PositionMotor(1, {})}, NoSleep(), {0, 1, 0});
    rig.world.Run(2);
    EXPECT_NEAR(rig.Place(), 1, 1e-3);
    EXPECT_NEAR(rig.Speed(), 0, 1e-3);
    EXPECT_NEAR(rig.Forces().motor, 10 * kGravity, 0.1);
}

TEST(Motor, AForceLimitBoundsAPositionMotor) {
    JointMotor motor = PositionMotor(5, FrequencySpring(4, 1));
    motor.minForce = -20;
    motor.maxForce = 20;
    SliderRig rig(10, {.motor = motor});
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), 1, Rounding(1, 30) + 1e-5);
    EXPECT_NEAR(rig.Forces().motor, 20, 1e-2);
}

// Where its force does not suffice, it is the force alone that moves the body, no correction of its pose.
TEST(Motor, AForceLimitBoundsAPositionMotorWithoutASpring) {
    JointMotor motor = PositionMotor(5, {});
    motor.minForce = -20;
    motor.maxForce = 20;
    SliderRig rig(10, {.motor = motor});
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), 1, Rounding(1, 30) + 1e-5);
    EXPECT_NEAR(rig.Place(), 0.5 * 2 * 0.25, 0.5 * kStep / 4 + 1e-4);
    EXPECT_NEAR(rig.Forces().motor, 20, 1e-2);
    // It brakes on the second half of the way: 2 sqrt(2 m / f 5 / 2) seconds; then the last millimeters take their
    // time.
    double farthest = 0;
    for (int i = 30; i < 210; ++i) {
        rig.world.Step();
        farthest = std::max(farthest, rig.Place());
    }
    EXPECT_NEAR(rig.Place(), 5, 0.02);
    rig.world.Run(1);
    EXPECT_NEAR(rig.Place(), 5, 1e-3);
    EXPECT_NEAR(rig.Speed(), 0, 1e-3);
    EXPECT_LT(farthest, 5.02);
}

TEST(Motor, OneTooWeakToHoldItsPlaceSlowsTheFall) {
    JointMotor motor = PositionMotor(0, {});
    motor.minForce = -20;
    motor.maxForce = 20;
    SliderRig rig(10, {.motor = motor}, NoSleep(), {0, 1, 0});
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), -(kGravity - 2), 1e-3);
    EXPECT_NEAR(rig.Place(), -0.5 * (kGravity - 2), 0.5 * kGravity * kStep / 4 + 1e-3);
}

TEST(Motor, TargetsMayChangeEveryStep) {
    // A critically damped motor of 10 Hz follows a slow sine with the lag 2 zeta / w in time.
    SliderRig rig(2, {.motor = PositionMotor(0, FrequencySpring(10, 1))});
    const double rate = 2;
    for (int i = 0; i < 300; ++i) {
        const double time = i * kStep;
        ASSERT_TRUE(rig.Joints().SetMotor(rig.joint, JointAxis::LinearX,
                                          PositionMotor(std::sin(rate * time), FrequencySpring(10, 1))));
        rig.world.Step();
        // 2 zeta / w = 32 ms, and a target that stands still for a step is half a step old: within 1 rad/s * ... of the
        // amplitude.
        const double lag = 2 / (2 * kPi * 10) + kStep / 2;
        if (i > 60) {
            ASSERT_NEAR(rig.Place(), std::sin(rate * (time + kStep - lag)), 0.02) << "step " << i;
        }
    }
}

TEST(Motor, OneThatIsSwitchedOffHasNoForce) {
    SliderRig rig(2, {.motor = SpeedMotor(3)});
    rig.world.Run(0.5);
    ASSERT_TRUE(rig.Joints().SetMotor(rig.joint, JointAxis::LinearX, {}));
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), 3, Rounding(3, 60));
    EXPECT_EQ(rig.Forces().motor, 0);
    ASSERT_TRUE(rig.world.Bodies().SetVelocity(rig.box, {7, 0, 0}, {0, 0, 0}));
    rig.world.Run(0.5);
    EXPECT_NEAR(rig.Speed(), 7, Rounding(7, 30));
}

TEST(JointFriction, OfASliderSlowsByForceOverMassAndStops) {
    SliderRig rig(8000, {.friction = 16000});
    ASSERT_TRUE(rig.world.Bodies().SetVelocity(rig.box, {10, 0, 0}, {0, 0, 0}));
    rig.world.Run(2);
    EXPECT_NEAR(rig.Speed(), 6, Rounding(10, 120));
    // Substeps of h move at the speed of their end: a t h / 2 too short.
    const double h = kStep / 4;
    EXPECT_NEAR(rig.Place(), 10 * 2 - 0.5 * 2 * 4 - 2 * 2 * h / 2, 1e-4);
    EXPECT_NEAR(rig.Forces().friction, -16000, 1);
    rig.world.Run(3.5);
    EXPECT_NEAR(rig.Speed(), 0, 1e-5);
    // v^2 / 2a, less what the same makes of 5 s.
    EXPECT_NEAR(rig.Place(), 25 - 2 * 5 * h / 2, 1e-3);
}

TEST(JointFriction, OfASliderHoldsBelowItAndSlipsAboveIt) {
    for (const double push : {90.0, 110.0}) {
        SliderRig rig(20, {.friction = 100});
        for (int i = 0; i < 120; ++i) {
            ASSERT_TRUE(rig.world.Bodies().AddForce(rig.box, {static_cast<float>(push), 0, 0}));
            rig.world.Step();
        }
        if (push < 100) {
            EXPECT_NEAR(rig.Place(), 0, 1e-6);
            EXPECT_NEAR(rig.Forces().friction, -90, 0.05);
        } else {
            EXPECT_NEAR(rig.Speed(), 2 * 10.0 / 20, 1e-4);
            EXPECT_NEAR(rig.Place(), 0.5 * 4 * 10.0 / 20, 0.5 * 2 * kStep / 4 / 2 + 1e-4);
        }
    }
}

TEST(JointFriction, HoldsAWeightForAMinuteWithoutCreep) {
    SliderRig rig(20, {.friction = 200}, NoSleep(), {0, 1, 0});
    rig.world.Run(1);
    const double start = rig.Place();
    rig.world.Run(60);
    EXPECT_NEAR(rig.Place(), start, 1e-5);
    EXPECT_NEAR(start, 0, 1e-4);
}

TEST(JointFriction, OfAHingeSlowsByTorqueOverInertiaAndStops) {
    HingeRig rig(3, {.friction = 2});
    const double inertia = 3 * HingeRig::kUnitInertia, deceleration = 2 / inertia;
    ASSERT_TRUE(rig.world.Bodies().SetVelocity(rig.rod, {0, 2.5f, 0}, {0, 0, 5}));
    rig.world.Run(1);
    EXPECT_NEAR(rig.Speed(), 5 - deceleration, 0.005 * 5);
    rig.world.Run(4);
    EXPECT_NEAR(rig.Speed(), 0, 1e-4);
    EXPECT_NEAR(rig.Angle(), 25 / (2 * deceleration), 0.01 * 25 / (2 * deceleration));
}

TEST(JointFriction, OfAHingeHoldsARodBelowItsTorqueAndNotAboveIt) {
    // m g l = 14.7 N m.
    for (const double friction : {15.0, 14.0}) {
        HingeRig rig(3, {.friction = static_cast<float>(friction)}, NoSleep());
        rig.world.Run(2);
        if (friction > 14.7) {
            // It slips while friction is not yet there in the first step: v = g dt / 4 is braked by 0.3 N m. Then it
            // holds.
            EXPECT_NEAR(rig.Angle(), 0, 2e-3);
            const double start = rig.Angle();
            rig.world.Run(20);
            EXPECT_NEAR(rig.Angle(), start, 1e-5);
        } else {
            EXPECT_LT(rig.Angle(), -0.2);
        }
    }
}

TEST(JointFriction, OfASwingTwistJointBrakesAboutEachAxis) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .angularVelocity = {4, 0, 0}, .mass = 10});
    SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
    settings.twist.friction = settings.swingY.friction = settings.swingZ.friction = 1;
    Join(world, settings);
    // I = 1.
    world.Run(1);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).x(), 3, 1e-4);
    // Friction is about the axes of B's frame: that of z alone is in the way.
    ASSERT_TRUE(world.Bodies().SetPose(ball, {0, 0, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, 0, 0}, {0, 0, 4}));
    world.Run(1);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).z(), 3, 1e-4);
    world.Run(4);
    EXPECT_NEAR(Length(world.Bodies().GetAngularVelocity(ball)), 0, 1e-5);
}

}  // namespace
}  // namespace fulcrum::testing
