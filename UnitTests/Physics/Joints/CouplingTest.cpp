// Gears, racks and pulleys: ratios, what they share out of an impulse, and that no tooth is lost. Momentum of jointed
// bodies.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

namespace fulcrum::testing {
namespace {

// A wheel about z with a bearing to the hook, inertia as given.
struct Wheel {
    BodyId body;
    JointId bearing;
};
Wheel AddWheel(TestWorld& world, BodyId hook, const Position& position, double inertia, double speed,
               bool driven = false) {
    const auto i = static_cast<float>(inertia);
    Wheel wheel;
    wheel.body = world.Add({.shape = SphereOf(0.1f),
                            .position = position,
                            .angularVelocity = {0, 0, static_cast<float>(speed)},
                            .mass = 1,
                            .inertia = {i, i, i}});
    HingeJointSettings settings{Between(hook, wheel.body, position, {0, 0, 1})};
    settings.angle = Limited(-1e6, 1e6);  // never reached: with them turns are counted
    if (driven) settings.angle.motor = SpeedMotor(speed);
    wheel.bearing = Join(world, settings);
    return wheel;
}
double SpeedOf(TestWorld& world, const Wheel& wheel) {
    return double(world.Bodies().GetAngularVelocity(wheel.body).z());
}
double AngleOf(TestWorld& world, const Wheel& wheel) {
    return JointsOf(world).GetCoordinate(wheel.bearing, JointAxis::AngularX);
}

TEST(Gear, ShareOutAnImpulseByTheirInertiasAndRatio) {
    // 100 : 400 teeth, I of discs of the same height and density: r^4. The big one turns at 3 rad/s when they mesh.
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const double small = 0.01, big = 2.56;
    const Wheel a = AddWheel(world, hook, {0, 0, 0}, small, 0), b = AddWheel(world, hook, {5, 0, 0}, big, 3);
    GearJointSettings settings{Between(a.body, b.body, {0, 0, 0}, {0, 0, 1})};
    settings.anchorB = AnchorAt({5, 0, 0}, {0, 0, 1});
    settings.ratio = 4;
    Join(world, settings);
    world.Step();
    const double expected = 3 * big / (big + 16 * small);
    EXPECT_NEAR(SpeedOf(world, b), expected, 1e-3 * expected);
    EXPECT_NEAR(SpeedOf(world, a), -4 * expected, 4e-3 * expected);
    world.Run(60);
    // No tooth is lost; speeds stay.
    EXPECT_NEAR(AngleOf(world, a) + 4 * AngleOf(world, b), 0, 1e-3);
    EXPECT_NEAR(SpeedOf(world, b), expected, 1e-3 * expected);
}

TEST(Gear, ADrivenTrainKeepsStepForAThousandTurns) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    std::vector<Wheel> wheels{AddWheel(world, hook, {0, 0, 0}, 0.1, 100, true)};
    const double ratios[] = {2, -3, 0.5};
    double product = 1;
    for (int i = 0; i < 3; ++i) {
        wheels.push_back(AddWheel(world, hook, {i + 1.0, 0, 0}, 0.1, 0));
        GearJointSettings settings{Between(wheels[i].body, wheels[i + 1].body, {double(i), 0, 0}, {0, 0, 1})};
        settings.anchorB = AnchorAt({i + 1.0, 0, 0}, {0, 0, 1});
        settings.ratio = static_cast<float>(ratios[i]);
        Join(world, settings);
        product *= -ratios[i];
    }
    world.Run(63);
    EXPECT_GT(AngleOf(world, wheels[0]), 1000 * 2 * kPi);
    EXPECT_NEAR(AngleOf(world, wheels[0]), product * AngleOf(world, wheels[3]), 5e-3);
    EXPECT_NEAR(SpeedOf(world, wheels[3]), 100 / product, 0.01);
}

TEST(Gear, ALoadOnOneIsFeltByTheOtherTimesTheRatio) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const Wheel a = AddWheel(world, hook, {0, 0, 0}, 0.1, 0), b = AddWheel(world, hook, {5, 0, 0}, 0.4, 0);
    GearJointSettings settings{Between(a.body, b.body, {0, 0, 0}, {0, 0, 1})};
    settings.anchorB = AnchorAt({5, 0, 0}, {0, 0, 1});
    settings.ratio = 3;
    Join(world, settings);
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(world.Bodies().AddTorque(a.body, {0, 0, 2}));
        world.Step();
    }
    // From B it is I_b + 9 I_a that 3 times the torque turns, backwards.
    EXPECT_NEAR(SpeedOf(world, b), -3 * 2 / (0.4 + 9 * 0.1), 1e-3 * 4.6);
}

TEST(RackAndPinion, TheRackMovesByTheRadiusTimesTheAngle) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const double radius = 0.25;
    const Wheel pinion = AddWheel(world, hook, {0, 0, 0}, 0.1, 4, true);
    const BodyId rack = world.Add({.shape = BoxOf(1, 0.05f, 0.05f), .position = {0, -0.25, 0}, .mass = 3});
    const JointId guide = Join(world, SliderJointSettings{Between(hook, rack, {0, -0.25, 0})});
    RackAndPinionJointSettings settings{Between(pinion.body, rack, {0, 0, 0}, {0, 0, 1})};
    settings.anchorB = AnchorAt({0, -0.25, 0});
    settings.ratio = static_cast<float>(1 / radius);
    Join(world, settings);
    world.Run(10);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(guide, JointAxis::LinearX), radius * AngleOf(world, pinion), 1e-3);
    EXPECT_NEAR(world.VelocityOf(rack).x(), radius * 4, 1e-3);
    EXPECT_NEAR(AngleOf(world, pinion), 40, 0.1);
}

TEST(RackAndPinion, AWeightOnTheRackSpinsThePinion) {
    // a = m g / (m + I / r^2).
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world);
    const double radius = 0.25, inertia = 0.1, mass = 3;
    const Wheel pinion = AddWheel(world, hook, {0, 0, 0}, inertia, 0);
    const BodyId rack =
        world.Add({.shape = BoxOf(0.05f, 1, 0.05f), .position = {0.25, 0, 0}, .mass = static_cast<float>(mass)});
    Join(world, SliderJointSettings{Between(hook, rack, {0.25, 0, 0}, {0, 1, 0})});
    RackAndPinionJointSettings settings{Between(pinion.body, rack, {0, 0, 0}, {0, 0, 1})};
    settings.anchorB = AnchorAt({0.25, 0, 0}, {0, 1, 0});
    settings.ratio = static_cast<float>(1 / radius);
    Join(world, settings);
    world.Run(1);
    const double acceleration = mass * kGravity / (mass + inertia / (radius * radius));
    EXPECT_NEAR(world.VelocityOf(rack).y(), -acceleration, 1e-3 * acceleration);
    EXPECT_NEAR(SpeedOf(world, pinion), -acceleration / radius, 1e-3 * acceleration / radius);
}

TEST(Pulley, EqualMassesAtARatioOfFour) {
    // l = yA + 4 yB: with the tension T on A and 4 T on B, aA = -4 aB: a = (-6.925, +1.731) m/s2.
    TestWorld world(NoSleep());
    const BodyId a = world.Add({.shape = SphereOf(0.1f), .position = {0, -20, 0}, .mass = 5});
    const BodyId b = world.Add({.shape = SphereOf(0.1f), .position = {3, -10, 0}, .mass = 5});
    PulleyJointSettings settings{Between(a, b, {0, -20, 0})};
    settings.anchorB = AnchorAt({3, -10, 0});
    settings.fixedPointB = {3, 0, 0};
    settings.ratio = 4;
    const JointId rope = Join(world, settings);
    const double length = JointsOf(world).GetCoordinate(rope, JointAxis::LinearX);
    EXPECT_NEAR(length, 60, 1e-5);
    world.Run(1);
    const double up = kGravity * 3 / 17, down = 4 * up;
    EXPECT_NEAR(down, 6.925, 1e-3);
    EXPECT_NEAR(world.VelocityOf(a).y(), -down, 2e-3 * down);
    EXPECT_NEAR(world.VelocityOf(b).y(), up, 2e-3 * up);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(rope, JointAxis::LinearX), length, 1e-3);
    // The tension: 5 (g - aA).
    EXPECT_NEAR(Length(JointsOf(world).GetForce(rope)), 4 * 5 * (kGravity - down), 0.005 * 60);
}

TEST(Pulley, ARopeIsSlackWhereItIsNotPulled) {
    TestWorld world(Weightless());
    const BodyId a = world.Add({.shape = SphereOf(0.1f), .position = {0, -2, 0}, .linearVelocity = {0, 1, 0}});
    const BodyId b = world.Add({.shape = SphereOf(0.1f), .position = {3, -2, 0}});
    PulleyJointSettings settings{Between(a, b, {0, -2, 0})};
    settings.anchorB = AnchorAt({3, -2, 0});
    settings.fixedPointB = {3, 0, 0};
    Join(world, settings);
    world.Run(1);
    EXPECT_NEAR(world.VelocityOf(a).y(), 1, 1e-6);
    EXPECT_EQ(world.VelocityOf(b).y(), 0);
}

// Eight links in a row, joined by `makeJoint`, hit at the end by a ball of 10 kg at 5 m/s.
template <class Settings>
void ExpectMomentumIsKept() {
    TestWorld world(Weightless());
    std::vector<BodyId> bodies;
    for (int i = 0; i < 8; ++i) {
        bodies.push_back(world.Add({.shape = BoxOf(0.45f, 0.1f, 0.1f),
                                    .position = {1.0 * i, 0, 0},
                                    .mass = 2,
                                    .material = {.friction = 0, .restitution = 0.5f}}));
        if (i > 0) Join(world, Settings{Between(bodies[i - 1], bodies[i], {i - 0.5, 0, 0}, {0, 0, 1})});
    }
    bodies.push_back(world.Add({.shape = SphereOf(0.2f),
                                .position = {7.2, 1, 0.03},
                                .linearVelocity = {0, -5, 0},
                                .mass = 10,
                                .material = {.friction = 0, .restitution = 0.5f}}));
    const auto momentum = [&](Position& linear, Position& angular) {
        linear = angular = Position::Zero();
        for (const BodyId id : bodies) {
            const Position p = world.VelocityOf(id).template cast<double>() * double(world.Bodies().GetMass(id));
            const Position x = world.Bodies().GetCenterOfMass(id);
            linear += p;
            angular +=
                Position(x.y() * p.z() - x.z() * p.y(), x.z() * p.x() - x.x() * p.z(), x.x() * p.y() - x.y() * p.x()) +
                world.Bodies().GetAngularMomentum(id).template cast<double>();
        }
    };
    Position linear, angular, linearAfter, angularAfter;
    momentum(linear, angular);
    world.Run(2);
    momentum(linearAfter, angularAfter);
    EXPECT_LT(world.VelocityOf(bodies[7]).y(), -0.1f);
    EXPECT_LT((linearAfter - linear).norm() / linear.norm(), 1e-4);
    // Impulses at joints act where the bodies were at the start of a substep, and links turn within it.
    EXPECT_LT((angularAfter - angular).norm() / angular.norm(), 0.005);
}

TEST(Momentum, OfAChainOfBallJointsHitByABall) { ExpectMomentumIsKept<PointJointSettings>(); }
TEST(Momentum, OfAChainOfHingesHitByABall) { ExpectMomentumIsKept<HingeJointSettings>(); }
TEST(Momentum, OfARodOfFixedJointsHitByABall) { ExpectMomentumIsKept<FixedJointSettings>(); }

}  // namespace
}  // namespace fulcrum::testing
