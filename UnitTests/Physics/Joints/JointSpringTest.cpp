// Springs of joints against the continuous oscillator, at 60 steps a second and the default settings.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

struct SpringCase {
    double frequency, dampingRatio;
    friend std::ostream& operator<<(std::ostream& out, const SpringCase& c) {
        return out << c.frequency << " Hz, zeta " << c.dampingRatio;
    }
};

// From the origin to a point of b, with a length at rest, m.
DistanceJointSettings SpringBetween(BodyId a, BodyId b, const Position& end, float atRest,
                                    const SpringSettings& spring) {
    DistanceJointSettings settings{Between(a, b, {0, 0, 0})};
    settings.anchorB = AnchorAt(end);
    settings.minDistance = settings.maxDistance = atRest;
    settings.spring = spring;
    return settings;
}

class JointSpring : public ::testing::TestWithParam<SpringCase> {
protected:
    double Frequency() const { return GetParam().frequency; }
    double DampingRatio() const { return GetParam().dampingRatio; }
    double Omega() const { return 2 * kPi * Frequency(); }
    SpringSettings ByFrequency() const { return FrequencySpring(Frequency(), DampingRatio()); }
    // k = m w^2, c = 2 zeta w m.
    SpringSettings ByStiffness(double mass) const {
        return StiffnessSpring(mass * Omega() * Omega(), 2 * DampingRatio() * Omega() * mass);
    }

    // Runs the world until the motion is a thousandth, 10 s at most, and holds the coordinate, which rests at `rest`,
    // against the closed form, within 1 %.
    void ExpectOscillator(TestWorld& world, JointId joint, JointAxis axis, double rest) const {
        const double seconds = std::min(10.0, std::log(1000.0) / (DampingRatio() * Omega()));
        std::vector<double> x{JointsOf(world).GetCoordinate(joint, axis) - rest};
        for (int i = 0; i < std::lround(seconds / kStep); ++i) {
            world.Step();
            x.push_back(JointsOf(world).GetCoordinate(joint, axis) - rest);
        }
        const Oscillator found =
            FitOscillator(x, kStep, static_cast<size_t>(std::max(1l, std::lround(1 / (Omega() * kStep)))));
        EXPECT_NEAR(found.frequency, Frequency(), 0.01 * Frequency());
        EXPECT_NEAR(found.dampingRatio, DampingRatio(), 0.01 * DampingRatio());
    }
};

INSTANTIATE_TEST_SUITE_P(FrequenciesAndDampings, JointSpring,
                         ::testing::Values(SpringCase{0.5, 0.05}, SpringCase{0.5, 0.3}, SpringCase{0.5, 1},
                                           SpringCase{2, 0.05}, SpringCase{2, 0.1}, SpringCase{2, 0.6},
                                           SpringCase{2, 1}, SpringCase{5, 0.05}, SpringCase{5, 0.2},
                                           SpringCase{5, 0.6}, SpringCase{5, 1}));

TEST_P(JointSpring, BetweenABodyAndTheWorldAtADistance) {
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(4)}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {1.5, 2, 0}, .mass = 4});
        const DistanceJointSettings settings = SpringBetween(hook, ball, {1.5, 2, 0}, 2.0f, spring);
        ExpectOscillator(world, Join(world, settings), JointAxis::LinearX, 2);
    }
}

TEST_P(JointSpring, BetweenTwoBodiesActsOnTheirReducedMass) {
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(0.75)}) {
        TestWorld world(Weightless());
        const BodyId light = world.Add({.shape = SphereOf(0.1f), .position = {0, 0, 0}, .mass = 1});
        const BodyId heavy = world.Add({.shape = SphereOf(0.1f), .position = {0, 0, 2.5}, .mass = 3});
        const DistanceJointSettings settings = SpringBetween(light, heavy, {0, 0, 2.5}, 2.0f, spring);
        ExpectOscillator(world, Join(world, settings), JointAxis::LinearX, 2);
    }
}

// A hundred times faster than locks are pulled together: this is a spring's own work. The distance stays positive.
TEST_P(JointSpring, CreatedFarFromRest) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {50, 0, 0}, .mass = 4});
    const DistanceJointSettings settings = SpringBetween(hook, ball, {50, 0, 0}, 25.0f, ByFrequency());
    ExpectOscillator(world, Join(world, settings), JointAxis::LinearX, 25);
}

TEST_P(JointSpring, OfASliderThatIsLockedSoftly) {
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(4)}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {0, 1, 0}, .mass = 4});
        const JointId slider =
            Join(world, SliderJointSettings{Between(hook, box, {0, 1, 0}, {0, 1, 0}), Limited(0.5, 0.5, spring)});
        ExpectOscillator(world, slider, JointAxis::LinearX, 0.5);
    }
}

TEST_P(JointSpring, OfAMotorOfASlider) {
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(4)}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {0, 1, 0}, .mass = 4});
        SliderJointSettings settings{Between(hook, box, {0, 1, 0}, {0, 1, 0})};
        settings.slide.motor = PositionMotor(-0.5, spring);
        ExpectOscillator(world, Join(world, settings), JointAxis::LinearX, -0.5);
    }
}

TEST_P(JointSpring, OfAHingeThroughTheCenter) {
    // I = 2/5 m r^2 = 0.4.
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(0.4)}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 4});
        HingeJointSettings settings{Between(hook, ball, {0, 0, 0}, {0, 0, 1})};
        settings.angle.motor = PositionMotor(0.5, spring);
        ExpectOscillator(world, Join(world, settings), JointAxis::AngularX, 0.5);
    }
}

TEST_P(JointSpring, OfAHingeAtTheEndOfARodMovesItsWholeInertia) {
    const double inertia = 3 * ((1 + 0.01) / 12 + 0.25);
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(inertia)}) {
        for (const bool isLimit : {false, true}) {
            TestWorld world(Weightless());
            const BodyId hook = AddHook(world);
            const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 3});
            HingeJointSettings settings{Between(hook, rod, {0, 0, 0}, {0, 0, 1})};
            if (isLimit) settings.angle = Limited(0.5, 0.5, spring);
            else settings.angle.motor = PositionMotor(0.5, spring);
            ExpectOscillator(world, Join(world, settings), JointAxis::AngularX, 0.5);
        }
    }
}

TEST_P(JointSpring, OfATwistMotorAndOfASixDofAxis) {
    for (const SpringSettings& spring : {ByFrequency(), ByStiffness(0.4)}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 4});
        const BodyId other = world.Add({.shape = SphereOf(0.5f), .position = {3, 0, 0}, .mass = 4});
        SwingTwistJointSettings twist{Between(hook, ball, {0, 0, 0}, {0, 0, 1})};
        twist.twist.motor = PositionMotor(0.5, spring);
        const JointId first = Join(world, twist);
        SixDofJointSettings six{UprightBetween(hook, other, {3, 0, 0})};
        for (int k = 0; k < 3; ++k) six.axes[static_cast<size_t>(k)] = kLockedAxis;
        six[JointAxis::AngularZ] = Limited(0, 0, spring);
        const JointId second = Join(world, six);
        ExpectOscillator(world, first, JointAxis::AngularX, 0.5);
        ASSERT_TRUE(world.Bodies().SetPose(other, {3, 0, 0}, RotationAbout({0, 0, 1}, 0.5)));
        ExpectOscillator(world, second, JointAxis::AngularZ, 0);
    }
}

TEST(JointSpringAtRest, AStiffnessCarriesAWeightAtForceOverStiffness) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world);
    const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {0, -1, 0}, .mass = 5});
    const double stiffness = 400;
    const JointId slider = Join(world, SliderJointSettings{Between(hook, box, {0, -1, 0}, {0, 1, 0}),
                                                           Limited(0, 0, StiffnessSpring(stiffness, 80))});
    world.Run(5);
    // What is left of a motion that decays at 8 /s is nothing; float coordinates of 0.1 m have steps of 1e-8.
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), -5 * kGravity / stiffness, 1e-5);
}

TEST(JointSpringAtRest, ACriticallyDampedFrequencyCarriesAWeightAtGOverOmegaSquared) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {0, -1, 0}, .mass = 7});
    const DistanceJointSettings settings = SpringBetween(hook, ball, {0, -1, 0}, 1.0f, FrequencySpring(2, 1));
    const JointId spring = Join(world, settings);
    world.Run(5);
    const double omega = 4 * kPi;
    EXPECT_NEAR(JointsOf(world).GetCoordinate(spring, JointAxis::LinearX), 1 + kGravity / (omega * omega), 1e-5);
}

TEST(JointSpringAtRest, ASpringOfMinAndMaxActsOnlyBeyondThem) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const BodyId ball =
        world.Add({.shape = SphereOf(0.1f), .position = {2, 0, 0}, .linearVelocity = {1, 0, 0}, .mass = 2});
    DistanceJointSettings settings{Between(hook, ball, {0, 0, 0})};
    settings.anchorB = AnchorAt({2, 0, 0});
    settings.minDistance = 1.0f;
    settings.maxDistance = 3.0f;
    settings.spring = FrequencySpring(1, 0, SpringForm::Exact);
    const JointId spring = Join(world, settings);
    // A free way, half an oscillation beyond the end with the amplitude v / w, and back with the same speed.
    double longest = 0;
    for (int i = 0; i < 150; ++i) {
        world.Step();
        const double distance = JointsOf(world).GetCoordinate(spring, JointAxis::LinearX);
        longest = std::max(longest, distance);
        if (distance < 3 && i < 60) {
            EXPECT_NEAR(world.VelocityOf(ball).x(), 1, 1e-6);
        }
    }
    // Where within a substep h it crosses the end is not known to the spring: a part w h / 2 of the amplitude.
    const double omega = 2 * kPi, tolerance = omega * kStep / 4 / 2;
    EXPECT_NEAR(longest, 3 + 1 / omega, tolerance / omega + 1e-3);
    EXPECT_NEAR(world.VelocityOf(ball).x(), -1, 2 * tolerance);
}

}  // namespace
}  // namespace fulcrum::testing
