// The meters of rest against closed forms: what slides, turns, falls asleep or gains energy by a known amount.
#include <Fulcrum/Samples/Scenes/RestMeters.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

SystemSettings Weightless() {
    SystemSettings settings = NoGravity();
    settings.sleep.enabled = false;
    return settings;
}

TEST(DriftMeter, OnlyTheWayAcrossGravityCounts) {
    TestWorld world(NoSleep());
    const BodyId thrown =
        world.Add({.shape = SphereOf(0.5f), .position = {10, 0, 0}, .linearVelocity = {0.3f, 5, 0.4f}});
    world.Add({.shape = SphereOf(0.5f)});
    const DriftMeter meter(world.System());
    EXPECT_EQ(meter.Measure().largest, 0);
    world.Run(2);
    // 0.5 m/s across for 2 s, and a body that falls straight.
    EXPECT_NEAR(meter.Measure().largest, 1, 1e-5);
    EXPECT_NEAR(meter.Measure().mean, 0.5, 1e-5);
    EXPECT_EQ(meter.Measure().farthest, thrown);
}

TEST(DriftMeter, EveryDirectionCountsWithoutGravity) {
    TestWorld world(Weightless());
    world.Add({.shape = SphereOf(0.5f), .linearVelocity = {0, 2, 0}});
    const DriftMeter meter(world.System());
    world.Run(1);
    EXPECT_NEAR(meter.Measure().largest, 2, 1e-5);
}

TEST(DriftMeter, ABoxSlidesAsFarAsItsFrictionLetsIt) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .linearVelocity = {0, 0, 2}});
    const DriftMeter meter(world.System());
    world.Run(2);
    // v^2 / (2 mu g). Where within its last substep the box stops is open: it may be off by that substep's way at the
    // speed that it starts with.
    EXPECT_NEAR(meter.Measure().largest, 4 / (2 * 0.5 * kGravity), 2 * kStep / 4);
    EXPECT_EQ(meter.Measure().farthest, box);
}

TEST(DriftMeter, RemovedAndLaterBodiesDoNotCount) {
    TestWorld world(Weightless());
    const BodyId gone = world.Add({.shape = SphereOf(0.5f), .linearVelocity = {9, 0, 0}});
    world.Add({.shape = SphereOf(0.5f), .position = {0, 5, 0}, .linearVelocity = {1, 0, 0}});
    const DriftMeter meter(world.System());
    world.Run(0.5);
    ASSERT_TRUE(world.Bodies().Remove(gone));
    world.Add({.shape = SphereOf(0.5f), .position = {0, -5, 0}, .linearVelocity = {3, 0, 0}});
    world.Run(0.5);
    EXPECT_NEAR(meter.Measure().largest, 1, 1e-5);
    EXPECT_NEAR(meter.Measure().mean, 1, 1e-5);
}

TEST(SpeedMeter, IsTheSpeedOfABodyThatFliesStraight) {
    TestWorld world(Weightless());
    const BodyId fast = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {3, 0, 4}});
    world.Add({.shape = CubeOf(0.5f), .position = {-9, 0, 0}, .linearVelocity = {-1, 0, 0}});
    SpeedMeter meter(world.System());
    world.Step();
    EXPECT_NEAR(meter.Measure(kStep), 5, 1e-4);
    EXPECT_EQ(meter.Fastest(), fast);
}

TEST(SpeedMeter, IsThatOfTheCornersOfABodyThatTurns) {
    TestWorld world(Weightless());
    world.Add({.shape = BoxOf(0.3f, 0.1f, 0.4f), .angularVelocity = {0, 6, 0}});
    SpeedMeter meter(world.System());
    world.Step();
    // The corners are half a meter from the axis: the chord of the angle that they turn by.
    EXPECT_NEAR(meter.Measure(kStep), 2 * 0.5 * std::sin(0.5 * 6 * kStep) / kStep, 1e-4);
}

TEST(SpeedMeter, SeesWhatMovesWithoutVelocity) {
    TestWorld world(Weightless());
    const BodyId body = world.Add({.shape = CubeOf(0.5f)});
    SpeedMeter meter(world.System());
    world.Step();
    EXPECT_EQ(meter.Measure(kStep), 0);
    ASSERT_TRUE(world.Bodies().SetPose(body, {0, 0.01, 0}, {}));
    // Positions are on a grid of 1.2e-7 m.
    EXPECT_NEAR(meter.Measure(kStep), 0.6, 1e-5);
    world.Step();
    EXPECT_LT(meter.Measure(kStep), 1e-5);
    EXPECT_NEAR(meter.Largest(), 0.6, 1e-5);  // of all steps
}

TEST(EnergyMeter, FreeFlightGainsNothing) {
    TestWorld world(NoSleep());
    world.Add({.shape = CubeOf(0.5f), .position = {0, 50, 0}});
    world.Add({.shape = BoxOf(0.1f, 0.4f, 0.9f),
               .position = {20, 50, 0},
               .linearVelocity = {1, 12, -3},
               .angularVelocity = {0.1f, 5, 0.1f}});
    EnergyMeter meter(world.System());
    for (int step = 0; step < 180; ++step) {
        world.Step();
        meter.Measure();
    }
    // Velocities are floats: their squares are exact to 1e-7, and a turning box keeps its energy to 1e-5
    // (FreeRotation).
    EXPECT_LT(meter.RelativeRise(), 1e-5);
}

TEST(EnergyMeter, AnElasticBallGainsNothing) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {0, 2.2, 0}, .material = {.restitution = 1}});
    EnergyMeter meter(world.System());
    int bounces = 0;
    for (int step = 0; step < 600; ++step) {
        const float before = world.VelocityOf(ball).y();
        world.Step();
        meter.Measure();
        if (before < 0 && world.VelocityOf(ball).y() > 0) ++bounces;
    }
    // Ten seconds have 8 falls of 0.64 s and as many rises; each rebound is held to 1e-4 of the drop (Restitution).
    EXPECT_EQ(bounces, 8);
    EXPECT_LT(meter.RelativeRise(), 8e-4);
}

TEST(EnergyMeter, AForceAddsItsWork) {
    TestWorld world(Weightless());
    const BodyId body = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {1, 0, 0}, .mass = 2});
    EnergyMeter meter(world.System());
    for (int step = 0; step < 60; ++step) {
        ASSERT_TRUE(world.Bodies().AddForce(body, {10, 0, 0}));
        world.Step();
        meter.Measure();
    }
    // 10 N for a second make 6 m/s of 1 m/s: 36 J of 1 J.
    EXPECT_NEAR(meter.Rise(), 35, 1e-3);
    EXPECT_NEAR(meter.RelativeRise(), 35, 1e-3);
}

TEST(EnergyMeter, ARiseIsAboveTheSmallestEnergySoFar) {
    TestWorld world(Weightless());
    const BodyId body = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {6, 0, 0}, .mass = 2});
    EnergyMeter meter(world.System());
    for (const float speed : {3.0f, 1.0f, 4.0f, 2.0f, 3.0f}) {
        ASSERT_TRUE(world.Bodies().SetVelocity(body, {speed, 0, 0}, {0, 0, 0}));
        meter.Measure();
    }
    EXPECT_NEAR(meter.Rise(), 16 - 1, 1e-6);
    EXPECT_NEAR(meter.RelativeRise(), 15.0 / 36, 1e-6);
}

TEST(EnergyMeter, IsRelativeToTheHeightAboveTheLowestPoint) {
    TestWorld world(NoSleep());
    const BodyId body = world.Add({.shape = BoxOf(0.5f, 2, 0.5f), .position = {0, 7, 0}, .mass = 3});
    EnergyMeter meter(world.System());
    ASSERT_TRUE(world.Bodies().SetVelocity(body, {2, 0, 0}, {0, 0, 0}));
    meter.Measure();
    // The center is 2 m above the box's lowest corners, wherever the origin is.
    EXPECT_NEAR(meter.Rise(), 0.5 * 3 * 4, 1e-4);
    EXPECT_NEAR(meter.RelativeRise(), 0.5 * 4 / (2 * kGravity), 1e-5);
}

TEST(TimeToSleep, IsThatOfARestingBox) {
    for (const float seconds : {0.5f, 1.25f}) {
        SystemSettings settings;
        settings.sleep.seconds = seconds;
        TestWorld world(settings);
        world.AddFloor();
        world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
        const auto time = TimeToSleep(world.System(), kStep, 5);
        ASSERT_TRUE(time && time.Value());
        EXPECT_NEAR(*time.Value(), double(seconds), 2.5 * kStep);
        EXPECT_TRUE(AllAsleep(world.System()));
    }
}

TEST(TimeToSleep, ComesAfterSliding) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .linearVelocity = {2, 0, 0}});
    const auto time = TimeToSleep(world.System(), kStep, 5);
    ASSERT_TRUE(time && time.Value());
    // Slow, below 0.05 m/s, after that speed is braked by mu g; then half a second, and up to a tenth for the means of
    // the velocity that must have forgotten the braking.
    EXPECT_NEAR(*time.Value(), (2 - 0.05) / (0.5 * kGravity) + 0.5 + 0.05, 0.05 + 2.5 * kStep);
}

TEST(TimeToSleep, IsNeverWithoutSleepingOrWithinTooLittleTime) {
    TestWorld awake(NoSleep()), sleepy;
    for (TestWorld* world : {&awake, &sleepy}) {
        world->AddFloor();
        world->Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
        const auto time = TimeToSleep(world->System(), kStep, 0.4);
        ASSERT_TRUE(time);
        EXPECT_FALSE(time.Value());
        EXPECT_EQ(world->Report().step, 24u);
    }
}

TEST(TimeToSleep, IsThatOfDynamicBodiesAlone) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Add(
        {.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {0, 9, 0}, .angularVelocity = {0, 1, 0}});
    const auto time = TimeToSleep(world.System(), kStep, 5);
    ASSERT_TRUE(time);
    EXPECT_TRUE(time.Value());
}

TEST(TimeToSleep, GivesTheErrorOfTheStep) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    EXPECT_FALSE(TimeToSleep(world.System(), 2, 5));
}

TEST(StepsIn, RoundsUp) {
    EXPECT_EQ(StepsIn(1, 1.0 / 60), 60);
    EXPECT_EQ(StepsIn(20, 1.0 / 60), 1200);
    EXPECT_EQ(StepsIn(1, 0.3), 4);
}

}  // namespace
}  // namespace fulcrum::testing
