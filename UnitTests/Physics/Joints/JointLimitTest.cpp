// Limits are never overshot, at any speed of motor or body; soft ones are springs; turns are counted without an end.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A limit row asks for the speed that ends the way within a substep. What is overshot is what motors near a limit may
// (the slop of 1e-3, AxisControl.h) and what a soft row leaks in the steps after it arrested a body.
constexpr double kOvershoot = 5e-3;

class LimitAtSpeed : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Speeds, LimitAtSpeed, ::testing::Values(1, 10, 100, 1000));

// The motor runs to and fro; it must reach each end and stay within.
void ExpectWithin(TestWorld& world, JointId joint, JointAxis axis, double min, double max, double speed, double force) {
    for (int half = 0; half < 6; ++half) {
        ASSERT_TRUE(JointsOf(world).SetMotor(joint, axis, SpeedMotor(half % 2 ? -speed : speed, force)));
        for (int i = 0; i < 150; ++i) {
            world.Step();
            const double place = JointsOf(world).GetCoordinate(joint, axis);
            ASSERT_GE(place, min - kOvershoot) << "half " << half << " step " << i;
            ASSERT_LE(place, max + kOvershoot) << "half " << half << " step " << i;
        }
        EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, axis), half % 2 ? min : max, kOvershoot);
    }
    EXPECT_TRUE(world.AllFinite());
}

TEST_P(LimitAtSpeed, AHingeIsNotDrivenThroughItsLimits) {
    for (const double force : {double(JointRow::kUnlimited), 500.0}) {
        TestWorld world(Weightless());
        const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f),
                                      .position = {0.5, 0, 0},
                                      .mass = 1,
                                      .maxLinearSpeed = 2000,
                                      .maxAngularSpeed = 2000});
        const JointId hinge =
            Join(world, HingeJointSettings{Between(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}), Limited(-1, 0.5)});
        ExpectWithin(world, hinge, JointAxis::AngularX, -1, 0.5, GetParam(), force);
    }
}

TEST_P(LimitAtSpeed, ASliderIsNotDrivenThroughItsLimits) {
    for (const double force : {double(JointRow::kUnlimited), 500.0}) {
        TestWorld world(Weightless());
        const BodyId box = world.Add({.shape = CubeOf(0.1f), .mass = 1, .maxLinearSpeed = 2000});
        const JointId slider =
            Join(world, SliderJointSettings{Between(AddHook(world), box, {0, 0, 0}, {0, 1, 0}), Limited(-0.2, 0.5)});
        ExpectWithin(world, slider, JointAxis::LinearX, -0.2, 0.5, GetParam(), force);
    }
}

TEST_P(LimitAtSpeed, ATwistIsNotDrivenThroughItsLimits) {
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 1, .maxAngularSpeed = 2000});
    SwingTwistJointSettings settings{Between(AddHook(world), ball, {0, 0, 0})};
    settings.twist = Limited(-1, 0.5);
    const JointId joint = Join(world, settings);
    ExpectWithin(world, joint, JointAxis::AngularX, -1, 0.5, GetParam(), 500);
}

TEST_P(LimitAtSpeed, WhatFliesAgainstAStopStopsThere) {
    TestWorld world(Weightless());
    const auto speed = static_cast<float>(GetParam()), turning = std::min(speed, 100.0f);
    const BodyId box =
        world.Add({.shape = CubeOf(0.1f), .linearVelocity = {speed, 0, 0}, .mass = 1, .maxLinearSpeed = 2000});
    const JointId slider =
        Join(world, SliderJointSettings{Between(AddHook(world), box, {0, 0, 0}), Limited(-0.2, 0.5)});
    const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f),
                                  .position = {0.5, 5, 0},
                                  .linearVelocity = {0, 0.5f * turning, 0},
                                  .angularVelocity = {0, 0, turning},
                                  .mass = 1,
                                  .maxLinearSpeed = 2000,
                                  .maxAngularSpeed = 2000});
    const JointId hinge = Join(
        world, HingeJointSettings{Between(AddHook(world, {0, 5, 0}), rod, {0, 5, 0}, {0, 0, 1}), Limited(-1, 0.5)});
    for (int i = 0; i < 60; ++i) {
        world.Step();
        ASSERT_LE(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 0.5 + kOvershoot);
        ASSERT_LE(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), 0.5 + kOvershoot);
    }
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 0.5, kOvershoot);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), 0.5, kOvershoot);
}

TEST_P(LimitAtSpeed, ARopeIsNotTornLonger) {
    TestWorld world(Weightless());
    const auto speed = static_cast<float>(GetParam());
    const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                   .position = {1, 0, 0},
                                   .linearVelocity = {speed, 0.3f * speed, 0},
                                   .mass = 1,
                                   .maxLinearSpeed = 2000});
    DistanceJointSettings settings{Between(AddHook(world), ball, {0, 0, 0})};
    settings.anchorB = AnchorAt({1, 0, 0});
    settings.maxDistance = 2.0f;
    const JointId rope = Join(world, settings);
    // The rope's direction is that of the step's start: s = 0.3 v dt across it lengthens it to sqrt(l^2 + s^2).
    const double way = 0.3 * GetParam() * kStep, tangent = std::sqrt(4 + way * way) - 2;
    for (int i = 0; i < 120; ++i) {
        world.Step();
        ASSERT_LE(JointsOf(world).GetCoordinate(rope, JointAxis::LinearX), 2 + tangent + kOvershoot) << "step " << i;
    }
}

TEST(Limit, AHingeRestsOnItsLimit) {
    TestWorld world(NoSleep());
    const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 3});
    const JointId hinge =
        Join(world, HingeJointSettings{Between(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}), Limited(-0.3, 2)});
    world.Run(3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), -0.3, kOvershoot);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(rod).z(), 0, 1e-4);
    // The stop carries m g l cos(0.3).
    const double torque = 3 * kGravity * 0.5 * std::cos(0.3);
    EXPECT_NEAR(JointsOf(world).GetAxisForces(hinge, JointAxis::AngularX).limit, torque, 0.002 * torque);
}

TEST(Limit, ASoftLimitOfASliderIsASpring) {
    // With v = 1 m/s: half a period beyond the limit, up to v / w, and back as fast.
    TestWorld world(Weightless());
    const double omega = 2 * kPi * 2;
    const BodyId box = world.Add({.shape = CubeOf(0.1f), .linearVelocity = {1, 0, 0}, .mass = 3});
    const JointId slider = Join(world, SliderJointSettings{Between(AddHook(world), box, {0, 0, 0}),
                                                           Limited(-9, 0.5, FrequencySpring(2, 0, SpringForm::Exact))});
    double farthest = 0;
    for (int i = 0; i < 75; ++i) {
        world.Step();
        farthest = std::max(farthest, JointsOf(world).GetCoordinate(slider, JointAxis::LinearX));
    }
    // It begins to act somewhere within a substep h: a part w h / 2 of the motion.
    const double tolerance = omega * kStep / 4 / 2;
    EXPECT_NEAR(farthest - 0.5, 1 / omega, tolerance / omega + 1e-3);
    EXPECT_NEAR(world.VelocityOf(box).x(), -1, 2 * tolerance);
}

TEST(Limit, ASoftLimitOfAHingeCarriesAtTorqueOverStiffness) {
    TestWorld world(NoSleep());
    const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 3});
    const JointId hinge = Join(world, HingeJointSettings{Between(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}),
                                                         Limited(-0.3, 2, StiffnessSpring(200, 40))});
    world.Run(6);
    const double angle = JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX);
    EXPECT_NEAR(200 * (-0.3 - angle), 3 * kGravity * 0.5 * std::cos(angle), 0.005 * 3 * kGravity * 0.5);
}

TEST(Limit, LimitsMayBeChangedAndTakenAway) {
    TestWorld world(Weightless());
    const BodyId box = world.Add({.shape = CubeOf(0.1f), .mass = 1});
    SliderJointSettings settings{Between(AddHook(world), box, {0, 0, 0}), Limited(-1, 1)};
    settings.slide.motor = SpeedMotor(2);
    const JointId slider = Join(world, settings);
    world.Run(1);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 1, kOvershoot);
    ASSERT_TRUE(JointsOf(world).SetLimits(slider, JointAxis::LinearX, JointLimits{-1, 0.25f, {}}));
    world.Run(1);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 0.25, kOvershoot);
    ASSERT_TRUE(JointsOf(world).SetLimits(slider, JointAxis::LinearX, std::nullopt));
    world.Run(1);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 2.25, 0.02);
}

TEST(Limit, OfManyTurnsIsMetOnTheRightTurn) {
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .mass = 1});
    HingeJointSettings settings{Between(AddHook(world), ball, {0, 0, 0}, {0, 0, 1}), Limited(-1, 20)};
    settings.angle.motor = SpeedMotor(15);
    const JointId hinge = Join(world, settings);
    world.Run(3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), 20, kOvershoot);
    // 20 rad are three turns and 1.15 rad.
    const Quaternion q = world.Bodies().GetPose(ball).rotation;
    EXPECT_NEAR(double(q.z) * (q.w < 0 ? -1 : 1), std::sin(0.5 * (20 - 6 * kPi)), kOvershoot);
}

TEST(Limit, AHingeCountsAHundredThousandTurns) {
    // 180 rad/s are 3 radians a step; 209440 steps, and a tenth of that under the sanitizers.
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .mass = 1});
    HingeJointSettings settings{Between(AddHook(world), ball, {0, 0, 0}, {0, 0, 1})};
    settings.angle.motor = SpeedMotor(180);
    const JointId hinge = Join(world, settings);
    const double turns = Cases(100000);
    const int steps = static_cast<int>(std::ceil(turns * 2 * kPi / 180 / kStep));
    world.Steps(steps);
    const double angle = JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX);
    // The speed is held to a part of 1e-6 or so, which is a tenth of a turn.
    EXPECT_NEAR(angle / (2 * kPi), 180 * kStep * steps / (2 * kPi), 0.1);
    // Not a turn too many: the pose agrees, within what the orientation's own rounding, 1e-7 a step at random, adds up
    // to.
    const Quaternion q = world.Bodies().GetPose(ball).rotation;
    EXPECT_NEAR(std::remainder(angle - 2 * std::atan2(double(q.z), double(q.w)), 2 * kPi), 0, 1e-4);
    ASSERT_TRUE(
        JointsOf(world).SetMotor(hinge, JointAxis::AngularX, PositionMotor(turns * 2 * kPi, FrequencySpring(1, 1))));
    world.Run(5);
    // Floats of 6e5 have steps of 1/16: that is how exactly the target can be told.
    EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), double(static_cast<float>(turns * 2 * kPi)),
                1e-3);
}

}  // namespace
}  // namespace fulcrum::testing
