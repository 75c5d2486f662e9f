// What the report says of depths, gaps, energy, momentum and pushes, against closed forms.
#include <Fulcrum/Physics/Joints/GearJoint.h>
#include <Fulcrum/Physics/Joints/HingeJoint.h>
#include <Fulcrum/Physics/Joints/PointJoint.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

SystemSettings Measured(SystemSettings settings = NoSleep()) {
    settings.measuresErrors = true;
    return settings;
}
SystemSettings MeasuredWithoutGravity() {
    SystemSettings settings = NoGravity();
    settings.sleep.enabled = false;
    return Measured(settings);
}

TEST(StepErrors, AreZeroWhereNobodyAsks) {
    TestWorld world(NoSleep());
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.4, 0}});
    world.Step();
    const StepErrors& errors = world.Report().errors;
    EXPECT_FALSE(errors.areMeasured);
    EXPECT_EQ(errors.energyChange, 0);
    EXPECT_EQ(errors.pushEnergy, 0);
    EXPECT_EQ(errors.mostPushed, BodyId{});
}

TEST(StepErrors, ABoxPutTenMillimetersIntoTheFloorIsThatDeep) {
    TestWorld world(Measured());
    const BodyId floor = world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {5, 0.495, 0}});
    const BodyId deep = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.49, 0}});
    world.Step();
    const StepReport& report = world.Report();
    EXPECT_NEAR(report.largestPenetration, 0.01, 1e-6);
    EXPECT_TRUE((report.deepestA == deep && report.deepestB == floor) ||
                (report.deepestA == floor && report.deepestB == deep));
    EXPECT_EQ(report.errors.mostPushed, deep);
}

TEST(StepErrors, AJointPulledFiveMillimetersApartIsThatWide) {
    TestWorld world(MeasuredWithoutGravity());
    const BodyId a = world.Add({.shape = CubeOf(0.5f)}), b = world.Add({.shape = CubeOf(0.5f), .position = {2, 0, 0}});
    PointJointSettings settings;
    settings.bodyA = a;
    settings.bodyB = b;
    settings.anchorA.point = {1, 0, 0};
    settings.anchorB = JointAnchor{.point = {1, 0.005, 0}};
    const JointId joint = world.System().Joints().Create(settings).Value();
    world.Step();
    const StepReport& report = world.Report();
    EXPECT_NEAR(report.largestJointError, 0.005, 1e-7);
    EXPECT_EQ(report.worstJoint, joint);
    // It is pulled together by what is inside of the island alone.
    EXPECT_LT(report.errors.momentumError, 1e-4);
    EXPECT_GT(report.errors.pushEnergy, 0);
    EXPECT_TRUE(report.errors.mostPushed == a || report.errors.mostPushed == b);
}

// A hinge, its sides 0.1 rad out of line about an axis that it locks.
TEST(StepErrors, AHingeOutOfLineHasThatAngle) {
    TestWorld world(MeasuredWithoutGravity());
    HingeJointSettings settings;
    settings.bodyA = world.Add({.shape = CubeOf(0.5f)});
    settings.bodyB = world.Add({.shape = CubeOf(0.5f), .position = {2, 0, 0}});
    const float angle = 0.1f;
    settings.anchorA = {.point = {1, 0, 0}, .axis = {0, 1, 0}};
    settings.anchorB = JointAnchor{.point = {1, 0, 0}, .axis = {std::sin(angle), std::cos(angle), 0}};
    const JointId joint = world.System().Joints().Create(settings).Value();
    world.Step();
    EXPECT_NEAR(world.Report().largestJointAngle, 0.1, 1e-5);
    EXPECT_EQ(world.Report().mostTurnedJoint, joint);
}

// Kinetic energy becomes what the fall takes of the potential: the sum stays, up to the rounding of velocities: 2^-24
// of each of them in a step, m v^2 times that of the energy.
TEST(StepErrors, AFreeFallKeepsItsEnergy) {
    TestWorld world(Measured());
    const float mass = 3;
    const BodyId body = world.Add({.shape = SphereOf(0.5f), .linearVelocity = {2, 1, 0}, .mass = mass});
    for (int step = 0; step < 120; ++step) {
        world.Step();
        const double speed = world.VelocityOf(body).norm();
        const StepErrors& errors = world.Report().errors;
        ASSERT_TRUE(errors.areMeasured);
        ASSERT_LT(std::fabs(errors.energyChange), 2 * mass * speed * speed * 0x1p-24) << step;
        ASSERT_LT(errors.energyGain, 2 * mass * speed * speed * 0x1p-24) << step;
        ASSERT_LT(errors.momentumError, 2 * mass * speed * 0x1p-24) << step;
        ASSERT_EQ(errors.pushEnergy, 0) << step;
    }
}

// A force's work F s and a torque's are no error.
TEST(StepErrors, WhatTheUserPushesIsExplained) {
    TestWorld world(MeasuredWithoutGravity());
    const BodyId body = world.Add({.shape = SphereOf(0.5f), .mass = 2});
    for (int step = 0; step < 60; ++step) {
        ASSERT_TRUE(world.Bodies().AddForce(body, Vector3(10, 0, 0)));
        ASSERT_TRUE(world.Bodies().AddTorque(body, Vector3(0, 0.5f, 0)));
        world.Step();
        ASSERT_LT(std::fabs(world.Report().errors.energyChange), 1e-4) << step;
        ASSERT_LT(world.Report().errors.momentumError, 1e-5) << step;
        ASSERT_LT(world.Report().errors.angularMomentumError, 1e-5) << step;
    }
    EXPECT_NEAR(world.VelocityOf(body).x(), 10.0 / 2, 1e-4);
}

// Two balls of 1 and 3 kg that hit each other at 4 m/s and stick with restitution e lose (1 - e^2) mu v^2 / 2 of their
// energy, mu = m1 m2 / (m1 + m2), and none of their momentum.
TEST(StepErrors, ACollisionLosesTheEnergyThatNewtonSaysAndKeepsMomentum) {
    for (const float restitution : {0.0f, 0.5f, 1.0f}) {
        TestWorld world(MeasuredWithoutGravity());
        const Material material{.friction = 0, .restitution = restitution};
        world.Add({.shape = SphereOf(0.5f), .linearVelocity = {4, 0, 0}, .mass = 1, .material = material});
        world.Add({.shape = SphereOf(0.5f), .position = {1.5, 0.2, 0}, .mass = 3, .material = material});
        // Along the line of the centers as they touch: sin = 0.2.
        const double along = 4 * std::sqrt(1 - 0.2 * 0.2),
                     lost = (1 - restitution * restitution) * 0.5 * 0.75 * along * along;
        double change = 0;
        for (int step = 0; step < 60; ++step) {
            world.Step();
            const StepErrors& errors = world.Report().errors;
            change += errors.energyChange;
            ASSERT_LT(errors.energyGain, 1e-3) << restitution << " step " << step;
            ASSERT_LT(errors.momentumError, 1e-5) << restitution << " step " << step;
            // Arms are those of the start of the step, in which the balls move on by 4 m/s h across the impulse at
            // most.
            ASSERT_LT(errors.angularMomentumError, (1 + restitution) * 0.75 * along * 4 * 0.2 * kStep)
                << restitution << " step " << step;
        }
        // The line of the centers turns while they come closer within the step of the hit.
        EXPECT_NEAR(change, -lost, 0.02 * 0.5 * 0.75 * 16) << restitution;
    }
}

// Without gravity bodies that were created in each other come apart at depenetrationSpeed, v of which each of two equal
// ones has a half, and keep none: both have m (v / 2)^2 / 2.
TEST(StepErrors, PushesHaveTheEnergyOfTheirSpeed) {
    for (const float speed : {0.25f, 0.5f, 1.0f}) {
        SystemSettings settings = MeasuredWithoutGravity();
        settings.depenetrationSpeed = speed;
        TestWorld world(settings);
        const float mass = 8;
        world.Add({.shape = SphereOf(0.5f), .mass = mass});
        world.Add({.shape = SphereOf(0.5f), .position = {0.8, 0, 0}, .mass = mass});
        world.Step();
        const StepErrors& errors = world.Report().errors;
        const double each = 0.5 * mass * 0.25 * speed * speed;
        // Soft rows give way by 2 % of that speed.
        EXPECT_NEAR(errors.largestPushEnergy, each, 0.05 * each) << speed;
        EXPECT_NEAR(errors.pushEnergy, 2 * errors.largestPushEnergy, 1e-6 * each) << speed;
        EXPECT_LT(errors.energyGain, 1e-3 * each) << speed;
    }
}

TEST(StepErrors, WhatLandsAndRestsIsHardlyPushed) {
    TestWorld world(Measured());
    world.AddFloor();
    const float mass = 1000;
    world.Add({.shape = CubeOf(0.5f), .position = {0, 2, 0}, .linearVelocity = {3, 0, 0}, .mass = mass});
    double most = 0;
    for (int step = 0; step < 240; ++step) {
        world.Step();
        most = std::max(most, world.Report().errors.pushEnergy);
    }
    // It lands at 5.4 m/s with 14.7 kJ; impulses that a substep repeats of the one before lift it for one substep.
    EXPECT_LT(most, 0.05 * 0.5 * mass * 5.4 * 5.4);
    EXPECT_LT(world.Report().errors.pushEnergy, 1e-6);
}

// Gears turn in bearings of the world: their angular momentum is not theirs to keep. Of two balls that only touch it
// is.
TEST(StepErrors, WhatTheWorldHoldsHasNoMomentumError) {
    TestWorld world(MeasuredWithoutGravity());
    GearJointSettings gear;
    gear.bodyA = world.Add({.shape = SphereOf(0.5f), .angularVelocity = {4, 0, 0}});
    gear.bodyB = world.Add({.shape = SphereOf(0.5f), .position = {0, 2, 0}});
    gear.anchorA.axis = Vector3(1, 0, 0);
    gear.ratio = 3;
    ASSERT_TRUE(world.System().Joints().Create(gear));
    world.Step();
    EXPECT_EQ(world.Report().errors.angularMomentumError, 0);
    EXPECT_EQ(world.Report().errors.angularMomentumBody, BodyId{});
}

// A box without gyroscopic torque turns with a constant angular velocity: its momentum turns with it, which is wrong.
// |dL| in a step of h is h |w x I w|, up to h |w| of that.
TEST(StepErrors, ASpinWithoutGyroscopicTorqueIsAnError) {
    TestWorld world(MeasuredWithoutGravity());
    const Vector3 w(0, 0.6f, 0.8f);
    const BodyId body =
        world.Add({.shape = BoxOf(0.05f, 0.2f, 0.45f), .angularVelocity = w, .mass = 10, .gyroscopicTorque = false});
    world.Step();
    // I = m / 3 (half extents squared): about y (0.05^2 + 0.45^2), about z (0.05^2 + 0.2^2).
    const double iy = 10.0 / 3 * (0.05 * 0.05 + 0.45 * 0.45), iz = 10.0 / 3 * (0.05 * 0.05 + 0.2 * 0.2);
    const double expected = kStep * std::fabs(double(w.y()) * double(w.z()) * (iz - iy));
    EXPECT_NEAR(world.Report().errors.angularMomentumError, expected, 0.02 * expected);
    EXPECT_EQ(world.Report().errors.angularMomentumBody, body);
}

// All numbers, and the world itself, are the same for any number of threads; the world also where nobody measures.
TEST(StepErrors, AreTheSameForAnyNumberOfThreads) {
    TestWorld one(Measured({}), 1), four(Measured({}), 4), silent(SystemSettings{}, 2);
    MixedScene scenes[] = {MixedScene(one), MixedScene(four), MixedScene(silent)};
    for (int step = 0; step < 120; ++step) {
        for (MixedScene& scene : scenes) scene.BeforeStep(step);
        for (TestWorld* world : {&one, &four, &silent}) world->Step();
        const StepErrors &a = one.Report().errors, &b = four.Report().errors;
        ASSERT_TRUE(a.areMeasured);
        ASSERT_EQ(a.energyChange, b.energyChange) << step;
        ASSERT_EQ(a.energyGain, b.energyGain) << step;
        ASSERT_EQ(a.mostGaining, b.mostGaining) << step;
        ASSERT_EQ(a.momentumError, b.momentumError) << step;
        ASSERT_EQ(a.momentumBody, b.momentumBody) << step;
        ASSERT_EQ(a.angularMomentumError, b.angularMomentumError) << step;
        ASSERT_EQ(a.pushEnergy, b.pushEnergy) << step;
        ASSERT_EQ(a.mostPushed, b.mostPushed) << step;
        ASSERT_EQ(one.System().HashPoses(), silent.System().HashPoses()) << step;
    }
}

}  // namespace
}  // namespace fulcrum::testing
