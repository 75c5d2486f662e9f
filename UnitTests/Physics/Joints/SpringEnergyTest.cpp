// Springs of joints keep what their damping leaves them: against the damped oscillator over ten seconds, at all
// efforts; and no number of them on a body gains energy, at any frequency.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

SystemSettings WithSubsteps(int substeps) {
    SystemSettings settings = Weightless();
    settings.solver.substeps = substeps;
    return settings;
}

struct EnergyCase {
    int substeps;
    double frequency, dampingRatio;
    friend std::ostream& operator<<(std::ostream& out, const EnergyCase& c) {
        return out << c.frequency << " Hz, zeta " << c.dampingRatio << ", " << c.substeps << " substeps";
    }
};

// All whose frequency is below a tenth of the substep rate.
std::vector<EnergyCase> EnergyCases() {
    std::vector<EnergyCase> cases;
    for (const int substeps : {1, 4, 16})
        for (const double frequency : {0.5, 2.0, 5.0, 10.0})
            for (const double dampingRatio : {0.0, 0.05, 0.5, 1.0, 2.0})
                if (frequency * kStep / substeps < 0.1) cases.push_back({substeps, frequency, dampingRatio});
    return cases;
}

class SpringEnergy : public ::testing::TestWithParam<EnergyCase> {
protected:
    SystemSettings Settings() const { return WithSubsteps(GetParam().substeps); }
    SpringSettings Spring() const { return FrequencySpring(GetParam().frequency, GetParam().dampingRatio); }

    // Of samples x of a damped oscillator, x(n)^2 - x(n + lag) x(n - lag) falls as its energy does, by e^(-2 zeta w t).
    // Until a ten-thousandth is left of it, or what rounding allows of an overdamped one, whose faster motion ends
    // soon.
    void ExpectEnergy(TestWorld& world, JointId joint, JointAxis axis, double rest) const {
        const auto [substeps, frequency, dampingRatio] = GetParam();
        const double omega = 2 * kPi * frequency, decay = 2 * dampingRatio * omega;
        const double seconds = std::min(10.0, std::log(1e4) / decay);
        const auto lag = static_cast<size_t>(std::max(1l, std::lround(1 / (omega * kStep))));
        const auto count = std::max(static_cast<size_t>(std::lround(seconds / kStep)), 4 * lag + 2);
        std::vector<double> x;
        for (size_t i = 0; i < count; ++i) {
            world.Step();
            x.push_back(JointsOf(world).GetCoordinate(joint, axis) - rest);
        }
        const auto energy = [&](size_t i) { return x[i] * x[i] - x[i + lag] * x[i - lag]; };
        const double first = energy(lag), time = kStep;
        for (size_t i = lag; i + lag < count; ++i) {
            const double expected = first * std::exp(-decay * time * static_cast<double>(i - lag));
            // Of floats at a meter.
            const double rounding = 4e-7 * (std::abs(x[i]) + std::abs(x[i + lag]) + std::abs(x[i - lag]));
            ASSERT_NEAR(energy(i), expected, 0.01 * std::abs(expected) + rounding) << i;
        }
        const Oscillator found = FitOscillator(x, kStep, lag);
        EXPECT_NEAR(found.frequency, frequency, 0.01 * frequency);
        EXPECT_NEAR(found.dampingRatio, dampingRatio, 0.01 * dampingRatio + 1e-5);
    }
};

INSTANTIATE_TEST_SUITE_P(All, SpringEnergy, ::testing::ValuesIn(EnergyCases()));

TEST_P(SpringEnergy, OfADistance) {
    TestWorld world(Settings());
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {1, 0.75, 0}, .mass = 4});
    DistanceJointSettings settings{Between(hook, ball, {0, 0, 0})};
    settings.anchorB = AnchorAt({1, 0.75, 0});
    settings.minDistance = settings.maxDistance = 1;
    settings.spring = Spring();
    ExpectEnergy(world, Join(world, settings), JointAxis::LinearX, 1);
}

TEST_P(SpringEnergy, OfASliderLockedBySoftLimits) {
    TestWorld world(Settings());
    const BodyId base = world.Add({.shape = CubeOf(0.2f), .mass = 3});
    const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {0, 1, 0}, .mass = 4});
    const JointId slider =
        Join(world, SliderJointSettings{Between(base, box, {0, 1, 0}, {0, 1, 0}), Limited(0.3, 0.3, Spring())});
    ExpectEnergy(world, slider, JointAxis::LinearX, 0.3);
}

TEST_P(SpringEnergy, OfSixMotorsOfASixDofJoint) {
    TestWorld world(Settings());
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 4});
    SixDofJointSettings settings{UprightBetween(hook, ball, {0, 0, 0})};
    for (AxisControl& axis : settings.axes) axis.motor = PositionMotor(0, Spring());
    settings[JointAxis::LinearZ].motor.targetPosition = 0.3f;
    ExpectEnergy(world, Join(world, settings), JointAxis::LinearZ, 0.3);
}

TEST_P(SpringEnergy, OfAHinge) {
    TestWorld world(Settings());
    const BodyId base = world.Add({.shape = SphereOf(0.5f), .mass = 2});
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 4});
    HingeJointSettings settings{Between(base, ball, {0, 0, 0}, {0, 0, 1})};
    settings.angle.motor = PositionMotor(0.5, Spring());
    ExpectEnergy(world, Join(world, settings), JointAxis::AngularX, 0.5);
}

// The same rows, solved directly with all joints of the island at once.
TEST_P(SpringEnergy, OfADirectlySolvedHinge) {
    SystemSettings settings = Settings();
    settings.exactJointLoad = 1e-6f;
    TestWorld world(settings);
    const BodyId hook = AddHook(world);
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 4});
    HingeJointSettings hinge{Between(hook, ball, {0, 0, 0}, {0, 0, 1})};
    hinge.angle.motor = PositionMotor(0.5, Spring());
    const JointId joint = Join(world, hinge);
    // Hangs from it, free to turn, and makes it a mechanism.
    const BodyId other = world.Add({.shape = SphereOf(0.1f), .position = {0, 0, 1}, .mass = 4});
    Join(world, PointJointSettings{Between(ball, other, {0, 0, 1})});
    ExpectEnergy(world, joint, JointAxis::AngularX, 0.5);
}

struct SeveralCase {
    int substeps, springs;
    friend std::ostream& operator<<(std::ostream& out, const SeveralCase& c) {
        return out << c.springs << " springs, " << c.substeps << " substeps";
    }
};

class SpringsOnABody : public ::testing::TestWithParam<SeveralCase> {};

std::vector<SeveralCase> SeveralCases() {
    std::vector<SeveralCase> cases;
    for (const int substeps : {1, 4})
        for (const int springs : {1, 2, 3, 4, 6, 8, 12, 24}) cases.push_back({substeps, springs});
    return cases;
}
INSTANTIATE_TEST_SUITE_P(All, SpringsOnABody, ::testing::ValuesIn(SeveralCases()));

// The largest part of its first kinetic energy that a ball on springs has in 300 steps. They pull at its center from
// random directions, or are given by stiffness and pull at points beside the center, from random directions or all
// along a line.
enum class Pull { AtCenter, Beside, InLine };
double LargestPart(const SeveralCase& c, Pull pull, double frequency, double dampingRatio, SpringForm form) {
    TestWorld world(WithSubsteps(c.substeps));
    const BodyId hook = AddHook(world);
    const double mass = 2, radius = 0.3, inertia = 0.4 * mass * radius * radius, omega = 2 * kPi * frequency;
    const BodyId ball = world.Add({.shape = SphereOf(static_cast<float>(radius)),
                                   .linearVelocity = {1, 0.5f, -0.3f},
                                   .mass = static_cast<float>(mass)});
    RandomPoses random(7);
    for (int i = 0; i < c.springs; ++i) {
        const Vector3 direction = pull == Pull::InLine ? Vector3(1, 0, 0) : Vector3(random.InBox(1.0f).normalized()),
                      from = direction * 2.0f,
                      to = pull == Pull::AtCenter ? Vector3(Vector3::Zero()) : Vector3(random.InBox(0.1f));
        DistanceJointSettings settings{Between(hook, ball, from.cast<double>())};
        settings.anchorB = AnchorAt(to.cast<double>());
        settings.minDistance = settings.maxDistance = Length(Vector3(from - to));
        settings.spring = pull == Pull::AtCenter
                              ? FrequencySpring(frequency, dampingRatio, form)
                              : StiffnessSpring(mass * omega * omega, 2 * dampingRatio * omega * mass, form);
        Join(world, settings);
    }
    const auto kinetic = [&] {
        const Vector3 v = world.VelocityOf(ball), w = world.Bodies().GetAngularVelocity(ball);
        return 0.5 * mass * double{Dot(v, v)} + 0.5 * inertia * double{Dot(w, w)};
    };
    const double first = kinetic();
    double most = 0;
    for (int i = 0; i < 300; ++i) {
        world.Step();
        most = std::max(most, kinetic());
    }
    return most / first;
}

// Up to a quarter of the kinetic energy may be missing from the energy that is kept (SpringSettings.h). Springs of more
// than a period in six substeps that pull beside the center are nearly locks that contradict each other: what
// iterations leave of that is no more than of implicit ones.
TEST_P(SpringsOnABody, NeverGain) {
    for (const Pull pull : {Pull::AtCenter, Pull::Beside, Pull::InLine})
        for (const double dampingRatio : {0.0, 0.1, 1.0})
            for (double frequency = 0.5; frequency < 3e4; frequency *= 2) {
                const double most = LargestPart(GetParam(), pull, frequency, dampingRatio, SpringForm::Automatic);
                const bool isStiff = pull != Pull::AtCenter && frequency * kStep / GetParam().substeps > 1.0 / 6;
                const double allowed =
                    isStiff ? LargestPart(GetParam(), pull, frequency, dampingRatio, SpringForm::Implicit) : 1;
                EXPECT_LT(most, 1.35 * std::max(1.0, allowed))
                    << frequency << " Hz, zeta " << dampingRatio << ", pull " << static_cast<int>(pull);
            }
}

// Each end gives back the speed: no more after twenty seconds between two of them.
TEST(SpringEnergyOfLimits, StaysBetweenTwoSoftEnds) {
    for (const int substeps : {1, 4})
        for (const double frequency : {0.5, 2.0, 5.0, 20.0, 1000.0}) {
            TestWorld world(WithSubsteps(substeps));
            const BodyId hook = AddHook(world);
            const BodyId box = world.Add({.shape = CubeOf(0.2f), .linearVelocity = {0, 2, 0}, .mass = 4});
            Join(world, SliderJointSettings{Between(hook, box, {0, 0, 0}, {0, 1, 0}),
                                            Limited(-0.5, 0.5, FrequencySpring(frequency, 0))});
            double fastest = 0, atEnd = 0;
            for (int i = 0; i < 1200; ++i) {
                world.Step();
                const double speed = std::abs(double{world.VelocityOf(box).y()});
                fastest = std::max(fastest, speed);
                if (i >= 1080) atEnd = std::max(atEnd, speed);
            }
            // Where in a substep an end is reached is not known to the spring: a part w h / 2 of the speed.
            const double part = std::min(1.0, 2 * kPi * frequency * kStep / substeps / 2);
            EXPECT_LT(fastest, 2 * (1 + part)) << frequency << " Hz, " << substeps;
            if (frequency * kStep / substeps < 0.02) {
                EXPECT_GT(atEnd, 1.96) << frequency;
            }
        }
}

// What needs no more substeps moves the same whether efforts are adapted or not.
TEST(SpringEnergyOfEfforts, IsTheSameAdaptedOrFixed) {
    const auto run = [](bool adapts) {
        SystemSettings settings = NoSleep();
        if (!adapts) {
            settings.accuracy.penetration = settings.accuracy.jointError = std::numeric_limits<float>::infinity();
            settings.exactJointLoad = std::numeric_limits<float>::infinity();
        }
        TestWorld world(settings);
        const BodyId hook = AddHook(world);
        BodyId last = hook;
        for (int i = 0; i < 3; ++i) {
            const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {0, -1.0 - i, 0}, .mass = 2});
            DistanceJointSettings spring{Between(last, ball, {0, -double(i), 0})};
            spring.anchorB = AnchorAt({0, -1.0 - i, 0});
            spring.minDistance = spring.maxDistance = 1;
            spring.spring = FrequencySpring(3, 0);
            Join(world, spring);
            last = ball;
        }
        world.Run(5);
        return BitsOf(world, last);
    };
    EXPECT_TRUE(run(true) == run(false));
}

}  // namespace
}  // namespace fulcrum::testing
