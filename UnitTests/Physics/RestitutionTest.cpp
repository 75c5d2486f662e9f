// What is dropped bounces with the energy that its restitution leaves it.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr double kRadius = 0.2, kDrop = 2.0;

// What counts as no bounce must not end the bouncing too early.
SystemSettings Bouncy() {
    SystemSettings settings = NoSleep();
    settings.restitutionSpeed = 0.01f;
    return settings;
}

BodyId AddBall(TestWorld& world, float restitution) {
    return world.Add({.shape = SphereOf(static_cast<float>(kRadius)),
                      .position = {0, kRadius + kDrop, 0},
                      .material = {.restitution = restitution}});
}

class Restitution : public ::testing::TestWithParam<float> {};

TEST_P(Restitution, ReboundsToItsSquareTimesTheHeight) {
    const float e = GetParam();
    TestWorld world(Bouncy());
    world.AddFloor();
    const BodyId ball = AddBall(world, e);
    while (world.VelocityOf(ball).y() <= 0 && world.Report().step < 120) world.Step();
    // Free flight is exact, so the height that it will reach is known at once.
    const double v = double(world.VelocityOf(ball).y());
    const double height = world.PositionOf(ball).y() - kRadius + v * v / (2 * kGravity);
    const double slop = double(world.System().Settings().penetrationSlop);
    // After the bounce the ball is at the floor, give or take the slop. Without a bounce it stays there.
    EXPECT_NEAR(height, double(e) * double(e) * kDrop, 1e-4 * kDrop + 2 * slop);
}

TEST_P(Restitution, NeverRisesAboveWhereItFell) {
    TestWorld world(Bouncy());
    world.AddFloor();
    const BodyId ball = AddBall(world, GetParam());
    double highest = 0;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        highest = std::max(highest, world.PositionOf(ball).y());
    }
    EXPECT_LE(highest, kDrop + kRadius + double(world.System().Settings().penetrationSlop));
}

class FadingRestitution : public Restitution {};

TEST_P(FadingRestitution, ComesToRestAfterTheSumOfAllBounces) {
    const double e = double(GetParam()), dt = 1.0 / 240;
    TestWorld world(Bouncy());
    world.AddFloor();
    const BodyId ball = AddBall(world, GetParam());
    double lastMotion = 0;
    for (int i = 1; i < 2400; ++i) {
        world.Step(dt);
        if (std::fabs(double(world.VelocityOf(ball).y())) > 0.02) lastMotion = i * dt;
    }
    const double expected = std::sqrt(2 * kDrop / kGravity) * (1 + e) / (1 - e);
    // A bounce ends with its step: each loses at most one. It has 1 + log(v / 0.01) / log(1 / e) bounces of more than
    // 0.01 m/s.
    const double speed = std::sqrt(2 * kGravity * kDrop);
    const double bounces = e > 0 ? 1 + std::log(speed / 0.01) / std::log(1 / e) : 1;
    EXPECT_NEAR(lastMotion, expected, dt * (bounces + 1));
}

INSTANTIATE_TEST_SUITE_P(Coefficients, Restitution, ::testing::Values(0.0f, 0.3f, 0.5f, 0.8f, 0.95f, 1.0f));
INSTANTIATE_TEST_SUITE_P(Coefficients, FadingRestitution, ::testing::Values(0.0f, 0.3f, 0.5f, 0.8f));

TEST(Restitution, OneLosesNothingInTenSeconds) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId ball = AddBall(world, 1);
    const double start = world.System().GetEnergy();
    const double mass = double(world.Bodies().GetMass(ball));
    double least = start, most = start;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        least = std::min(least, world.System().GetEnergy());
        most = std::max(most, world.System().GetEnergy());
    }
    // About 8 bounces, each at a depth that differs from the last by no more than half a millimeter.
    const double tolerance = mass * kGravity * 8 * 0.5e-3;
    EXPECT_GT(least, start - tolerance);
    EXPECT_LT(most, start + tolerance);
}

TEST(Restitution, SlowImpactsDoNotBounce) {
    TestWorld world(NoSleep());
    world.AddFloor();
    // 0.4 m/s at the floor, below restitutionSpeed.
    const BodyId ball = world.Add(
        {.shape = SphereOf(0.2f), .position = {0, 0.2 + 0.16 / (2 * kGravity), 0}, .material = {.restitution = 1}});
    float fastest = 0;
    for (int i = 0; i < 60; ++i) {
        world.Step();
        fastest = std::max(fastest, world.VelocityOf(ball).y());
    }
    EXPECT_LT(fastest, 0.01f);
}

TEST(Restitution, EqualBallsSwapTheirVelocities) {
    TestWorld world(NoGravity());
    const Material elastic{.friction = 0, .restitution = 1};
    const BodyId left =
        world.Add({.shape = SphereOf(0.5f), .position = {-2, 0, 0}, .linearVelocity = {5, 0, 0}, .material = elastic});
    const BodyId right = world.Add({.shape = SphereOf(0.5f), .position = {0, 0, 0}, .material = elastic});
    world.Run(1);
    // Velocities of at most 5 m/s, rounded some ten times.
    EXPECT_NEAR(world.VelocityOf(left).x(), 0, 1e-5);
    EXPECT_NEAR(world.VelocityOf(right).x(), 5, 1e-5);
}

TEST(Restitution, UnequalBallsKeepMomentumAndEnergy) {
    TestWorld world(NoGravity());
    const Material elastic{.friction = 0, .restitution = 1};
    const BodyId light = world.Add(
        {.shape = SphereOf(0.5f), .position = {-2, 0, 0}, .linearVelocity = {4, 0, 0}, .mass = 1, .material = elastic});
    const BodyId heavy = world.Add({.shape = SphereOf(0.5f), .position = {0, 0, 0}, .mass = 3, .material = elastic});
    world.Run(1);
    // v1' = (m1 - m2) / (m1 + m2) v, v2' = 2 m1 / (m1 + m2) v.
    EXPECT_NEAR(world.VelocityOf(light).x(), -2, 1e-5);
    EXPECT_NEAR(world.VelocityOf(heavy).x(), 2, 1e-5);
}

TEST(Restitution, AFieldOfBallsKeepsItsEnergy) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0});
    for (int i = 0; i < 49; ++i)
        world.Add({.shape = SphereOf(0.1f),
                   .position = {i % 7 - 3.0, 5.0, i / 7 - 3.0},
                   .mass = 10,
                   .material = {.friction = 0, .restitution = 1}});
    // 49 balls of 10 kg with 4.9 m to fall, from rest height 0.1 m: 24034.5 J when rest counts as 0.
    const double rest = 49 * 10 * kGravity * 0.1, expected = 24034.5 - 49 * 10 * kGravity * 0.1;
    double squares = 0;
    for (int i = 0; i < 1200; ++i) {
        world.Step();
        const double error = world.System().GetEnergy() - rest - expected;
        squares += error * error;
    }
    // As in the ten seconds above: 10 bounces of at most the slop each, of 4.9 m.
    EXPECT_LT(std::sqrt(squares / 1200) / expected, 10 * 0.0005 / 4.9);
}

}  // namespace
}  // namespace fulcrum::testing
