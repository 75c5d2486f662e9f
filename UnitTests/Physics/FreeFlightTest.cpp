// Bodies that nothing touches, against the closed forms of mechanics.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// Each step rounds the velocity once: half a unit in the last place of the largest speed, in the worst case always to
// the same side, so that the position is off by the sum of a line.
double FlightTolerance(double largestSpeed, double seconds, double dt) {
    const double halfUlp = std::exp2(std::floor(std::log2(largestSpeed))) * std::exp2(-24);
    return halfUlp * (seconds / dt) * seconds / 2;
}

class Projectile : public ::testing::TestWithParam<double> {};

TEST_P(Projectile, LandsOnTheParabola) {
    const double dt = GetParam(), seconds = 10;
    TestWorld world;
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .linearVelocity = {-2, 2, 8}});
    world.Run(seconds, dt);
    const Position expected(-20, 20 - 0.5 * double(9.81f) * 100, 80);
    EXPECT_LT((world.PositionOf(ball) - expected).norm(), FlightTolerance(100, seconds, dt));
    // Symplectic Euler would be off by g T h / 2.
    EXPECT_LT((world.PositionOf(ball) - expected).norm(), 0.05 * kGravity * seconds * dt / 2 + 1e-3);
}

INSTANTIATE_TEST_SUITE_P(AnyTimeStep, Projectile, ::testing::Values(1.0 / 30, 1.0 / 60, 1.0 / 240));

TEST(FreeFlight, AGravityFactorScalesTheFall) {
    TestWorld world;
    const BodyId floats = world.Add({.shape = SphereOf(0.1f), .position = {0, 0, 0}, .gravityFactor = 0});
    const BodyId rises = world.Add({.shape = SphereOf(0.1f), .position = {5, 0, 0}, .gravityFactor = -0.5f});
    world.Run(2);
    EXPECT_EQ(world.PositionOf(floats), Position(0, 0, 0));
    EXPECT_NEAR(world.PositionOf(rises).y(), 0.25 * kGravity * 4, FlightTolerance(10, 2, kStep) + 1e-6);

    ASSERT_TRUE(world.Bodies().SetGravityFactor(floats, 2));
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(floats).y(), -kGravity, FlightTolerance(20, 1, kStep) + 1e-6);
}

TEST(FreeFlight, LinearDampingDecaysExponentially) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .linearVelocity = {10, 0, 0}, .linearDamping = 0.5f});
    world.Run(2);
    // 120 products, each rounded by 2^-24.
    EXPECT_NEAR(world.VelocityOf(ball).x(), 10 * std::exp(-1.0), 10 * 120 * std::exp2(-23));
    // x = v0 (1 - exp(-c t)) / c; the trapezoid is off by (c dt)^2 / 12 of it.
    const double distance = 10 * (1 - std::exp(-1.0)) / 0.5;
    EXPECT_NEAR(world.PositionOf(ball).x(), distance, distance * 1e-4);
}

TEST(FreeFlight, AngularDampingDecaysExponentially) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .angularVelocity = {0, 0, 5}, .angularDamping = 0.5f});
    const BodyId rod = world.Add(
        {.shape = BoxOf(0.1f, 1, 0.1f), .position = {5, 0, 0}, .angularVelocity = {0, 5, 0}, .angularDamping = 0.5f});
    world.Run(2);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).z(), 5 * std::exp(-1.0), 5 * 120 * std::exp2(-23));
    // The rod's angular velocity also goes through its momentum and back, some ten roundings a substep.
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(rod).y(), 5 * std::exp(-1.0), 5 * 120 * 4 * 10 * std::exp2(-24));
}

TEST(FreeFlight, AForceGivesForceOverMass) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .mass = 4});
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(box, {8, 0, 0}));
        world.Step();
    }
    EXPECT_NEAR(world.VelocityOf(box).x(), 2, 60 * std::exp2(-23));
    EXPECT_NEAR(world.PositionOf(box).x(), 1, FlightTolerance(2, 1, kStep) + 1e-6);
    // It acts during one step only.
    const Vector3 before = world.VelocityOf(box);
    world.Step();
    EXPECT_EQ(world.VelocityOf(box), before);
}

TEST(FreeFlight, ATorqueGivesTorqueOverInertia) {
    TestWorld world(NoGravity());
    // I = m (b^2 + c^2) / 3 of a box with half extents a, b, c.
    const BodyId box = world.Add({.shape = BoxOf(0.5f, 0.2f, 0.3f), .mass = 3});
    const double inertia = 3 * (0.25 + 0.09) / 3;
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(world.Bodies().AddTorque(box, {0, 1, 0}));
        world.Step();
    }
    // Rounded some ten times a substep, as above.
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 1 / inertia, 1 / inertia * 240 * 10 * std::exp2(-24));
    EXPECT_EQ(world.PositionOf(box), Position(0, 0, 0));
}

TEST(FreeFlight, AForceAtAPointTurnsTheBody) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 2});
    ASSERT_TRUE(world.Bodies().AddForceAt(ball, {0, 0, 6}, {0.5, 0, 0}));
    world.Step();
    EXPECT_NEAR(world.VelocityOf(ball).z(), 3 * kStep, 1e-7);
    // Torque r x F = (0.5, 0, 0) x (0, 0, 6) = (0, -3, 0); I = 2/5 m r^2 = 0.2.
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).y(), -15 * kStep, 1e-6);
}

TEST(FreeFlight, ImpulsesActAtOnce) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 2});
    ASSERT_TRUE(world.Bodies().AddImpulse(ball, {4, 0, 0}));
    EXPECT_FLOAT_EQ(world.VelocityOf(ball).x(), 2);
    ASSERT_TRUE(world.Bodies().AddAngularImpulse(ball, {0, 0, 1}));
    EXPECT_FLOAT_EQ(world.Bodies().GetAngularVelocity(ball).z(), 5);
    ASSERT_TRUE(world.Bodies().AddImpulseAt(ball, {0, 1, 0}, {0.5, 0, 0}));
    EXPECT_FLOAT_EQ(world.VelocityOf(ball).y(), 0.5f);
    EXPECT_FLOAT_EQ(world.Bodies().GetAngularVelocity(ball).z(), 7.5f);
    EXPECT_FLOAT_EQ(world.Bodies().GetVelocityAt(ball, {0, 0.5, 0}).x(), 2 - 7.5f * 0.5f);
    EXPECT_NEAR(world.Bodies().GetKineticEnergy(ball), 0.5 * 2 * (4 + 0.25) + 0.5 * 0.2 * 7.5 * 7.5, 1e-5);
}

TEST(FreeFlight, SpeedsAreHeldToTheirLimits) {
    TestWorld world;
    const BodyId ball =
        world.Add({.shape = SphereOf(0.5f), .angularVelocity = {0, 30, 0}, .maxLinearSpeed = 5, .maxAngularSpeed = 10});
    const BodyId rod = world.Add(
        {.shape = BoxOf(1, 0.1f, 0.1f), .position = {5, 0, 0}, .angularVelocity = {0, 30, 0}, .maxAngularSpeed = 10});
    world.Run(2);
    EXPECT_LE(Length(world.VelocityOf(ball)), 5 * (1 + 1e-6f));
    EXPECT_NEAR(Length(world.Bodies().GetAngularVelocity(ball)), 10, 1e-4);
    EXPECT_NEAR(Length(world.Bodies().GetAngularVelocity(rod)), 10, 1e-4);
    EXPECT_EQ(world.Report().clampedBodies, 1u);  // the ball goes on accelerating
}

}  // namespace
}  // namespace fulcrum::testing
