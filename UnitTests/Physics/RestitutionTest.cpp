// What is dropped bounces with the energy that its restitution leaves it.
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
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

constexpr int kEfforts[] = {1, 4, 16, 64};  // substeps

// A ball that hits a row of equal ones hands all of its speed to the last, whether they touch or have gaps that it
// crosses within a substep.
TEST(Restitution, ARowOfBallsHandsTheSpeedOn) {
    for (const int substeps : kEfforts)
        for (const double gap : {0.0, 0.001, 0.005, 0.05})
            for (const float speed : {1.0f, 3.0f, 12.0f})
                for (const int count : {4, 8}) {
                    // A body that moves by its own size in a substep is for continuous collision.
                    if (double{speed} * kStep / substeps > 0.1) continue;
                    SystemSettings settings = NoGravity();
                    settings.solver.substeps = substeps;
                    TestWorld world(settings);
                    std::vector<BodyId> balls;
                    for (int i = 0; i < count; ++i)
                        balls.push_back(
                            world.Add({.shape = SphereOf(0.1f),
                                       .position = {i == 0 ? -0.5 : (0.2 + gap) * (i - 1), 0, 0},
                                       .linearVelocity = i == 0 ? Vector3(speed, 0, 0) : Vector3(Vector3::Zero()),
                                       .material = {.friction = 0, .restitution = 1}}));
                    world.Run(1.5);
                    // One substep leaves up to 3 % in balls that it has collide a second time.
                    const double most = (substeps == 1 ? 0.03 : 1e-3) * speed;
                    for (int i = 0; i < count; ++i)
                        EXPECT_NEAR(world.VelocityOf(balls[size_t(i)]).x(), i + 1 == count ? speed : 0, most)
                            << substeps << " substeps, gap " << gap << ", ball " << i << " of " << count;
                }
}

struct BoxOfBalls {
    double end = 1, most = 1;  // energy after ten seconds, and the largest, of that at the start
};
// 125 balls without friction in a box of 3 m.
BoxOfBalls EnergyOfBalls(int substeps, float gravity, uint32_t seed) {
    SystemSettings settings = NoSleep();
    settings.solver.substeps = substeps;
    settings.gravity = {0, -gravity, 0};
    TestWorld world(settings);
    const Material elastic{.friction = 0, .restitution = 1};
    constexpr double kHalf = 1.5;
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
            Vector3 size(2.5f, 2.5f, 2.5f);
            size[axis] = 0.5f;
            Position at(Position::Zero());
            at[axis] = side * (kHalf + 0.5);
            world.Add({.shape = BoxOf(size.x(), size.y(), size.z()),
                       .motion = MotionType::Static,
                       .position = at,
                       .material = elastic});
        }
    RandomPoses random(seed);
    std::vector<BodyId> balls;
    for (int i = 0; i < 125; ++i)
        balls.push_back(world.Add({.shape = SphereOf(0.1f),
                                   .position = {-1 + 0.5 * (i % 5), -1 + 0.5 * (i / 5 % 5), -1 + 0.5 * (i / 25)},
                                   .linearVelocity = random.InBox(3),
                                   .material = elastic}));
    const auto energy = [&] {
        double sum = 0;
        for (const BodyId id : balls)
            sum += world.Bodies().GetKineticEnergy(id) + double{world.Bodies().GetMass(id)} * double{gravity} *
                                                             (world.Bodies().GetCenterOfMass(id).y() + kHalf);
        return sum;
    };
    BoxOfBalls result;
    const double start = energy();
    for (int i = 0; i < 600; ++i) {
        world.Step();
        result.end = energy() / start;
        result.most = std::max(result.most, result.end);
    }
    return result;
}

TEST(Restitution, ABoxOfElasticBallsKeepsItsEnergy) {
    for (const int substeps : kEfforts)
        for (const uint32_t seed : {1u, 2u}) {
            const BoxOfBalls flying = EnergyOfBalls(substeps, 0, seed), falling = EnergyOfBalls(substeps, 9.81f, seed);
            EXPECT_NEAR(flying.end, 1, 1e-4) << substeps;
            EXPECT_LT(flying.most, 1 + 1e-5) << substeps;
            // Impacts below restitutionSpeed lose theirs, and what is pressed is not in free flight.
            EXPECT_GT(falling.end, 0.995) << substeps;
            EXPECT_LT(falling.most, 1.0005) << substeps;
        }
}

// A ball that goes up hits the ceiling. Gravity draws it away from there, so it leaves a step faster than it came.
TEST(Restitution, ACeilingTakesNoEnergy) {
    for (const int substeps : kEfforts)
        for (const float speed : {4.0f, 6.3f, 8.1f}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            TestWorld world(settings);
            world.Add({.shape = BoxOf(2, 1, 2),
                       .motion = MotionType::Static,
                       .position = {0, 1, 0},
                       .material = {.friction = 0, .restitution = 1}});
            const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                           .position = {0, -0.7, 0},
                                           .linearVelocity = {0, speed, 0},
                                           .material = {.friction = 0, .restitution = 1}});
            for (int i = 0; i < 20 || world.VelocityOf(ball).y() > 0; ++i) world.Step();
            // Back where it started it has the speed with which it started.
            const double v = double{world.VelocityOf(ball).y()};
            EXPECT_NEAR(std::sqrt(v * v + 2 * kGravity * (world.PositionOf(ball).y() + 0.7)), double{speed}, 1e-3)
                << substeps;
        }
}

// A ball hits the floor obliquely, with spin w, at v = (1, -3). The tangential impulse J stops its surface, of which
// 2/7 of the slip is the center's, or slides: J / m = min(2/7 slip, mu (1 + e) 3); vx' = 1 -+ J / m, w' = w -+ J R / I.
TEST(Restitution, ASpinningBallLeavesWithTheTangentialRestitutionZero) {
    struct Case {
        float friction, restitution, spin;
    };
    for (const int substeps : kEfforts)
        for (const Case& c : {Case{0.5f, 0.5f, 20}, Case{0.5f, 0.5f, -50}, Case{0.1f, 0.8f, 30}, Case{0.9f, 1, -5},
                              Case{0.5f, 0, 20}, Case{0.1f, 0, -50}}) {
            SystemSettings settings = NoGravity();
            settings.solver.substeps = substeps;
            TestWorld world(settings);
            const Material material{.friction = c.friction, .restitution = c.restitution};
            world.AddFloor(material);
            const BodyId ball = world.Add({.shape = SphereOf(static_cast<float>(kRadius)),
                                           .position = {0, 0.487, 0},
                                           .linearVelocity = {1, -3, 0},
                                           .angularVelocity = {0, 0, c.spin},
                                           .material = material});
            world.Run(0.5);
            const double slip = 1 + double{c.spin} * kRadius;
            const double change = -std::copysign(
                std::min(2.0 / 7 * std::fabs(slip), double{c.friction} * (1 + double{c.restitution}) * 3), slip);
            EXPECT_NEAR(world.VelocityOf(ball).y(), 3 * c.restitution, 1e-3) << substeps;
            EXPECT_NEAR(world.VelocityOf(ball).x(), 1 + change, 1e-3) << substeps;
            EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).z(), double{c.spin} + change / (0.4 * kRadius), 1e-2)
                << substeps;
        }
}

}  // namespace
}  // namespace fulcrum::testing
