// Pendulums at the default settings against their closed forms.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/EllipticIntegral.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A rod of 1 x 0.1 x 0.1 m, hung up at the middle of its end face, released where it is horizontal.
struct RodPendulum {
    static constexpr double kInertia = (1 + 0.01) / 12 + 0.25;  // kg m2 about the hinge

    explicit RodPendulum(double mass = 1, const Vector3& along = Vector3(1, 0, 0),
                         const SystemSettings& settings = NoSleep())
        : world(settings) {
        const Vector3 axis = Cross(along, Vector3(0, 1, 0));
        // The rod is along its own x: turned about y.
        const double heading = std::atan2(-double(along.z()), double(along.x()));
        const BodyId hook = AddHook(world);
        rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f),
                         .position = 0.5 * along.cast<double>(),
                         .rotation = RotationAbout({0, 1, 0}, heading),
                         .mass = static_cast<float>(mass)});
        hinge = Join(world, HingeJointSettings{Between(hook, rod, {0, 0, 0}, axis)});
    }
    double Angle() { return JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX); }

    TestWorld world;
    BodyId rod;
    JointId hinge;
};

void ExpectTheClosedForm(RodPendulum& pendulum, double mass) {
    const double start = pendulum.world.System().GetEnergy(), scale = mass * kGravity * 0.5;
    double energyError = 0, gap = 0;
    ZeroCrossings crossings;
    for (int i = 0; i < 600; ++i) {
        pendulum.world.Step();
        crossings.Sample((i + 1) * kStep, std::sin(pendulum.Angle() + kPi / 2));  // it may get above the start
        energyError = std::max(energyError, std::fabs(pendulum.world.System().GetEnergy() - start) / scale);
        gap = std::max(gap, double(JointsOf(pendulum.world).GetError(pendulum.hinge).distance));
    }
    // T = 4 sqrt(I / (m g l)) K(sin(amplitude / 2)) = 1.93575 s.
    const double period = 4 * std::sqrt(RodPendulum::kInertia / (kGravity * 0.5)) * EllipticK(std::sin(kPi / 4));
    EXPECT_NEAR(period, 1.93575, 1e-5);
    ASSERT_GE(crossings.Count(), 10u);
    EXPECT_NEAR(crossings.Period(), period, 1e-3 * period);
    EXPECT_LT(energyError, 0.015);
    // A substep of h moves the end along a tangent of the arc; what it leaves the arc by is r (w h)^2 / 2 with w^2 = m
    // g l / I, 0.13 mm each, of which the joint's spring takes back a part at once.
    const double arc = 0.5 * 0.5 * (kGravity / RodPendulum::kInertia) * kStep * kStep / 16;
    EXPECT_LT(gap, 6 * arc);
}

TEST(Pendulum, ARodSwingsWithThePeriodOfTheEllipticIntegral) {
    RodPendulum pendulum;
    ExpectTheClosedForm(pendulum, 1);
}

TEST(Pendulum, MassAndHeadingDoNotMatter) {
    for (const double heading : {0.7, 2.0, -2.8}) {
        RodPendulum pendulum(300,
                             Vector3(static_cast<float>(std::cos(heading)), 0, static_cast<float>(std::sin(heading))));
        ExpectTheClosedForm(pendulum, 300);
    }
}

TEST(Pendulum, WhereItHangsDoesNotMatter) {
    // 10000 km from the origin, where a float would have steps of a meter.
    TestWorld near(NoSleep()), far(NoSleep());
    std::vector<BodyId> rods;
    for (auto [world, origin] : {std::pair<TestWorld*, Position>(&near, {0, 0, 0}), {&far, {1e7, 0, -1e7}}}) {
        const BodyId hook = AddHook(*world, origin);
        rods.push_back(world->Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = origin + Position(0.5, 0, 0)}));
        Join(*world, HingeJointSettings{Between(hook, rods.back(), origin, {0, 0, 1})});
    }
    near.Run(5);
    far.Run(5);
    // Doubles there have steps of 2 nm.
    EXPECT_LT((far.PositionOf(rods[1]) - Position(1e7, 0, -1e7) - near.PositionOf(rods[0])).norm(), 1e-5);
}

TEST(Pendulum, AShortSwingHasThePeriodOfTheHarmonicOscillator) {
    RodPendulum pendulum;
    // From hanging at rest to an amplitude of 5 degrees: w = 2 sin(amplitude / 2) sqrt(m g l / I), where v = w r.
    const double amplitude = 5 * kDegree, frequency = std::sqrt(kGravity * 0.5 / RodPendulum::kInertia);
    const double speed = 2 * std::sin(amplitude / 2) * frequency;
    ASSERT_TRUE(pendulum.world.Bodies().SetPose(pendulum.rod, {0, -0.5, 0}, RotationAbout({0, 0, 1}, -kPi / 2)));
    ASSERT_TRUE(pendulum.world.Bodies().SetVelocity(pendulum.rod, {static_cast<float>(0.5 * speed), 0, 0},
                                                    {0, 0, static_cast<float>(speed)}));
    ZeroCrossings crossings;
    double highest = 0;
    for (int i = 0; i < 600; ++i) {
        pendulum.world.Step();
        const double angle = pendulum.Angle() + kPi / 2;
        crossings.Sample((i + 1) * kStep, angle);
        highest = std::max(highest, std::fabs(angle));
    }
    const double period = 4 / frequency * EllipticK(std::sin(amplitude / 2));
    EXPECT_NEAR(crossings.Period(), period, 1e-3 * period);
    // 1 % of the energy is half a percent of the amplitude.
    EXPECT_NEAR(highest, amplitude, 0.005 * amplitude);
}

TEST(Pendulum, APointOnARodSwingsWithThePeriodOfTheEllipticIntegral) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.001f), .position = {-1, 0, 0}, .mass = 1});
    JointSettings between = Between(hook, ball, {0, 0, 0});
    between.anchorB = AnchorAt({-1, 0, 0});
    const JointId rod = Join(world, DistanceJointSettings{between});
    const double start = world.System().GetEnergy();
    ZeroCrossings crossings;
    double energyError = 0, stretch = 0;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        crossings.Sample((i + 1) * kStep, world.PositionOf(ball).x());
        energyError = std::max(energyError, std::fabs(world.System().GetEnergy() - start) / kGravity);
        stretch = std::max(stretch, std::fabs(JointsOf(world).GetCoordinate(rod, JointAxis::LinearX) - 1));
    }
    const double period = 4 * std::sqrt(1 / kGravity) * EllipticK(std::sin(kPi / 4));
    EXPECT_NEAR(period, 2.367842, 1e-6);
    EXPECT_NEAR(crossings.Period(), period, 1e-3 * period);
    EXPECT_LT(energyError, 0.01);
    EXPECT_LT(stretch, 1e-3);
    // After four periods and a quarter, at 4.3 m/s: 0.1 % of 10 s is 43 mm.
    EXPECT_LT((world.PositionOf(ball) - Position(-0.27509, -0.96142, 0)).norm(), 0.043);
}

TEST(Pendulum, ABallJointLeavesAConicalPendulumItsAngle) {
    // cos(a) = g / (w^2 l) for a body whose inertia is that of a sphere.
    TestWorld world(NoSleep());
    const double length = 1, speed = 5, cosine = kGravity / (speed * speed * length),
                 sine = std::sqrt(1 - cosine * cosine);
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                   .position = {length * sine, -length * cosine, 0},
                                   .linearVelocity = {0, 0, static_cast<float>(-speed * length * sine)},
                                   .angularVelocity = {0, static_cast<float>(speed), 0}});
    Join(world, PointJointSettings{Between(hook, ball, {0, 0, 0})});
    for (int i = 0; i < 600; ++i) {
        world.Step();
        // 1 % of its kinetic energy, w^2 l^2 sin^2(a) / 2 per kg, as height.
        EXPECT_NEAR(world.PositionOf(ball).y(), -length * cosine, 0.01 * speed * speed * sine * sine / (2 * kGravity));
    }
}

TEST(Pendulum, TwoRodsKeepTheirEnergy) {
    // Chaotic, so that only what is conserved can be held against mechanics: 1 % of m g l of both in 2 s.
    RodPendulum pendulum;
    TestWorld& world = pendulum.world;
    const BodyId second = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {1.5, 0, 0}, .mass = 1});
    const JointId elbow = Join(world, HingeJointSettings{Between(pendulum.rod, second, {1, 0, 0}, {0, 0, 1})});
    const double start = world.System().GetEnergy(), scale = kGravity * (0.5 + 1.5);
    for (int i = 0; i < 120; ++i) {
        world.Step();
        ASSERT_NEAR(world.System().GetEnergy(), start, 0.01 * scale) << "step " << i;
        ASSERT_LT(JointsOf(world).GetError(elbow).distance, 5e-3f);
        ASSERT_LT(JointsOf(world).GetError(elbow).angle, 1e-3f);
    }
}

}  // namespace
}  // namespace fulcrum::testing
