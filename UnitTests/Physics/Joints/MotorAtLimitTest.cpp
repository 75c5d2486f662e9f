// Motors that drive joints against their limits, of every kind, alone and in chains: the limits hold, nothing opens,
// and no motor gives more than it may.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace fulcrum::testing {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
// m or rad: a motor may be this far beyond a limit, see AxisControl.h.
constexpr double kSlop = 1e-3;

constexpr double kReach = kDegree;  // rad of angles, and that many meters of sliders

struct DrivenKind {
    const char* name;
    JointAxis driven;
    // Limited to kReach either way; its motor is set later.
    std::function<JointId(TestWorld&, const JointSettings&)> join;
    friend std::ostream& operator<<(std::ostream& out, const DrivenKind& kind) { return out << kind.name; }
};

JointId JoinSwingTwist(TestWorld& world, const JointSettings& between, SwingShape shape) {
    SwingTwistJointSettings settings{between};
    settings.shape = shape;
    settings.twist = settings.swingY = settings.swingZ = Limited(-kReach, kReach);
    return Join(world, settings);
}

JointId JoinSixDof(TestWorld& world, const JointSettings& between) {
    SixDofJointSettings settings{between};
    for (size_t axis = 0; axis < 6; ++axis) settings.axes[axis] = axis < 3 ? Limited(0, 0) : Limited(-kReach, kReach);
    return Join(world, settings);
}

const std::vector<DrivenKind>& DrivenKinds() {
    static const auto hinge = [](TestWorld& world, const JointSettings& between) {
        return Join(world, HingeJointSettings{between, Limited(-kReach, kReach)});
    };
    static const auto slider = [](TestWorld& world, const JointSettings& between) {
        return Join(world, SliderJointSettings{between, Limited(-kReach, kReach)});
    };
    static const auto ellipse = [](TestWorld& world, const JointSettings& between) {
        return JoinSwingTwist(world, between, SwingShape::Ellipse);
    };
    static const auto pyramid = [](TestWorld& world, const JointSettings& between) {
        return JoinSwingTwist(world, between, SwingShape::Pyramid);
    };
    static const std::vector<DrivenKind> kinds = {{"Hinge", JointAxis::AngularX, hinge},
                                                  {"Slider", JointAxis::LinearX, slider},
                                                  {"EllipseY", JointAxis::AngularY, ellipse},
                                                  {"EllipseZ", JointAxis::AngularZ, ellipse},
                                                  {"PyramidY", JointAxis::AngularY, pyramid},
                                                  {"PyramidZ", JointAxis::AngularZ, pyramid},
                                                  {"SixDofTwist", JointAxis::AngularX, JoinSixDof},
                                                  {"SixDofY", JointAxis::AngularY, JoinSixDof},
                                                  {"SixDofZ", JointAxis::AngularZ, JoinSixDof}};
    return kinds;
}

class DrivenChain : public ::testing::TestWithParam<DrivenKind> {
protected:
    // Links of 20 kg that hang from the world. upside: B of each joint is the upper body, else A.
    static std::vector<JointId> Hang(TestWorld& world, const DrivenKind& kind, int links, bool upside) {
        std::vector<JointId> joints;
        BodyId above = AddHook(world);
        for (int i = 0; i < links; ++i) {
            const BodyId link =
                world.Add({.shape = CapsuleOf(0.25f, 0.1f), .position = {0, -0.4 - 0.8 * i, 0}, .mass = 20});
            const Position point(0, -0.8 * i, 0);
            const JointSettings between = upside ? Between(link, above, point) : Between(above, link, point);
            joints.push_back(kind.join(world, between));
            above = link;
        }
        return joints;
    }
    static double BeyondOf(TestWorld& world, JointId joint, const DrivenKind& kind) {
        if (kind.driven == JointAxis::LinearX)
            return std::fabs(JointsOf(world).GetCoordinate(joint, JointAxis::LinearX)) - kReach;
        double most = std::fabs(JointsOf(world).GetCoordinate(joint, JointAxis::AngularX));
        if (kind.name != std::string("Hinge"))
            for (const JointAxis axis : {JointAxis::AngularY, JointAxis::AngularZ})
                most = std::max(most, std::fabs(JointsOf(world).GetCoordinate(joint, axis)));
        return most - kReach;
    }
};
INSTANTIATE_TEST_SUITE_P(Kinds, DrivenChain, ::testing::ValuesIn(DrivenKinds()));

TEST_P(DrivenChain, StaysWithinItsLimitsAndTogether) {
    const DrivenKind& kind = GetParam();
    // What slides along the edge of a cone moves along its tangent in a substep. Of six links with 500 N m, thin as
    // they are, that is as far as a cone of a degree is wide.
    const bool isCone = kind.name == std::string("EllipseY");
    for (const int links : {1, 2, 6})
        for (const int substeps : {1, 4, 16})
            for (const double force : {500.0, kUnlimited})
                for (const bool upside : {false, true}) {
                    if (isCone && links == 6 && force < kUnlimited) continue;
                    SystemSettings settings = NoSleep();
                    settings.solver.substeps = substeps;
                    TestWorld world(settings);
                    const std::vector<JointId> joints = Hang(world, kind, links, upside);
                    for (const JointId joint : joints)
                        ASSERT_TRUE(JointsOf(world).SetMotor(joint, kind.driven, SpeedMotor(20, force)));
                    double beyond = -1, gap = 0, most = 0;
                    for (int i = 0; i < 150; ++i) {
                        world.Step();
                        for (const JointId joint : joints) {
                            beyond = std::max(beyond, BeyondOf(world, joint, kind));
                            gap = std::max(gap, double(JointsOf(world).GetError(joint).distance));
                            const float motor = JointsOf(world).GetAxisForces(joint, kind.driven).motor;
                            most = std::max(most, std::fabs(double(motor)));
                        }
                    }
                    const auto what = [&] {
                        return ::testing::Message() << links << " links, " << substeps << " substeps, force " << force
                                                    << (upside ? ", upside down" : "");
                    };
                    EXPECT_LE(beyond, kSlop) << what();
                    EXPECT_LE(gap, 1e-3) << what();
                    EXPECT_LE(most, force * (1 + 1e-5)) << what();
                }
}

// To the other end and back, and with a target beyond the limit.
TEST_P(DrivenChain, ReachesTheLimitThatItIsDrivenAt) {
    const DrivenKind& kind = GetParam();
    for (const bool isPosition : {false, true}) {
        TestWorld world(Weightless());
        const std::vector<JointId> joints = Hang(world, kind, isPosition ? 1 : 3, false);
        for (const double sign : {1.0, -1.0, 1.0}) {
            for (const JointId joint : joints)
                ASSERT_TRUE(JointsOf(world).SetMotor(joint, kind.driven,
                                                     isPosition ? PositionMotor(sign, {}) : SpeedMotor(20 * sign)));
            world.Run(2);
            for (const JointId joint : joints)
                EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, kind.driven), sign * kReach, kSlop)
                    << (isPosition ? "position" : "speed");
        }
    }
}

// Half way to the limits nothing is slowed down.
TEST(MotorAtLimit, WithinTheLimitsAChainKeepsItsTargetSpeeds) {
    for (const JointAxis axis : {JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ}) {
        TestWorld world(Weightless());
        std::vector<JointId> joints;
        BodyId before = AddHook(world);
        for (int i = 0; i < 4; ++i) {
            const BodyId link = world.Add({.shape = CapsuleOf(0.25f, 0.1f), .position = {0, -0.4 - 0.8 * i, 0}});
            SixDofJointSettings settings{Between(before, link, {0, -0.8 * i, 0})};
            settings.axes.fill(Limited(0, 0));
            settings.axes[static_cast<size_t>(axis)] = Limited(-1, 1);
            settings.axes[static_cast<size_t>(axis)].motor = SpeedMotor(0.5);
            joints.push_back(Join(world, settings));
            before = link;
        }
        world.Run(1);
        for (const JointId joint : joints) EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, axis), 0.5, 1e-3);
    }
}

// A torque across the motor takes the swing along its edge, where the motor's axis leads out of the region.
TEST(MotorAtLimit, AMotorDoesNotLeaveASwingAlongItsEdge) {
    for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid})
        for (const float speed : {20.0f, 200.0f}) {
            TestWorld world(Weightless());
            const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 10});  // I = 1
            SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
            settings.shape = shape;
            settings.swingY = settings.swingZ = Limited(-kReach, kReach);
            settings.swingY.motor = SpeedMotor(speed, 100);
            const JointId joint = Join(world, settings);
            double widest = 0;
            for (int i = 0; i < 300; ++i) {
                ASSERT_TRUE(world.Bodies().AddTorque(ball, Vector3(0, 0, i % 60 < 30 ? 60.0f : -60.0f)));
                world.Step();
                const double y = JointsOf(world).GetCoordinate(joint, JointAxis::AngularY),
                             z = JointsOf(world).GetCoordinate(joint, JointAxis::AngularZ);
                widest = std::max(
                    widest, shape == SwingShape::Ellipse ? std::hypot(y, z) : std::max(std::fabs(y), std::fabs(z)));
            }
            EXPECT_LE(widest, kReach + kSlop) << (shape == SwingShape::Ellipse ? "ellipse " : "pyramid ") << speed;
        }
}

// Pressed into a corner a swing is beyond both faces by next to nothing, and what then kicks it across must not pass.
TEST(Limit, BothFacesOfAPyramidHoldAtItsCorner) {
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 10});  // I = 1
    SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
    settings.shape = SwingShape::Pyramid;
    settings.swingY = settings.swingZ = Limited(-kReach, kReach);
    const JointId joint = Join(world, settings);
    double widest = 0;
    for (int i = 0; i < 600; ++i) {
        const float kick = i % 20 == 19 ? 60.0f : 0.0f;  // 1 rad/s
        const bool isAlongY = i / 20 % 2 == 0;
        ASSERT_TRUE(world.Bodies().AddTorque(
            ball, Vector3(0, (isAlongY ? 30.0f + kick : 0.03f), (isAlongY ? 0.03f : 30.0f + kick))));
        world.Step();
        for (const JointAxis axis : {JointAxis::AngularY, JointAxis::AngularZ})
            widest = std::max(widest, JointsOf(world).GetCoordinate(joint, axis));
    }
    EXPECT_LE(widest, kReach + kSlop);
}

// Motors of joints that are solved one by one until they are set, and again after.
TEST(MotorAtLimit, AChainHoldsWhenItsMotorsAreSetWhileItRuns) {
    TestWorld world(NoSleep());
    std::vector<JointId> joints;
    BodyId before = AddHook(world);
    for (int i = 0; i < 6; ++i) {
        const BodyId link = world.Add({.shape = CapsuleOf(0.25f, 0.1f), .position = {0, -0.4 - 0.8 * i, 0}});
        HingeJointSettings settings{Between(before, link, {0, -0.8 * i, 0}, {0, 0, 1}), Limited(-kReach, kReach)};
        settings.angle.motor = PositionMotor(1, FrequencySpring(2, 1));
        joints.push_back(Join(world, settings));
        before = link;
    }
    double beyond = -1, gap = 0;
    for (int round = 0; round < 4; ++round) {
        for (const JointId joint : joints)
            ASSERT_TRUE(JointsOf(world).SetMotor(
                joint, JointAxis::AngularX,
                round % 2 == 0 ? SpeedMotor(round == 0 ? 20 : -20) : PositionMotor(1, FrequencySpring(2, 1))));
        for (int i = 0; i < 60; ++i) {
            world.Step();
            for (const JointId joint : joints) {
                const double angle = JointsOf(world).GetCoordinate(joint, JointAxis::AngularX);
                if (round % 2 == 0) beyond = std::max(beyond, std::fabs(angle) - kReach);
                gap = std::max(gap, double(JointsOf(world).GetError(joint).distance));
            }
        }
    }
    EXPECT_LE(beyond, kSlop);
    EXPECT_LE(gap, 1e-3);
}

}  // namespace
}  // namespace fulcrum::testing
