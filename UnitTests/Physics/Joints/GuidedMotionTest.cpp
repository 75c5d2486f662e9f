// Motions that joints guide through large angles, at the default settings, against their closed forms: beads on
// turning wires, hinges and limits of bodies that tumble, ends of ropes; and chains that carry a load.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace fulcrum::testing {
namespace {

SixDofJointSettings SixDofOf(const JointSettings& between, std::initializer_list<JointAxis> locked) {
    SixDofJointSettings settings = Of<SixDofJointSettings>(between);
    for (const JointAxis axis : locked) settings[axis] = kLockedAxis;
    return settings;
}

// Free along or about this axis, as the control has it, and in all other ways locked; or of rotations none.
SixDofJointSettings Guided(const JointSettings& between, JointAxis axis, bool isSingle, const AxisControl& control) {
    using enum JointAxis;
    SixDofJointSettings settings = SixDofOf(between, {LinearX, LinearY, LinearZ, AngularX, AngularY, AngularZ});
    if (!isSingle) settings[AngularX] = settings[AngularY] = settings[AngularZ] = AxisControl{};
    settings[axis] = control;
    return settings;
}

// A ball of 1 kg whose inertia is that of a sphere, I.
constexpr double kInertia = 0.1;  // kg m2
BodyId AddBall(TestWorld& world, const Position& position, const Vector3& velocity, const Vector3& angular) {
    const auto i = static_cast<float>(kInertia);
    return world.Add({.shape = SphereOf(0.05f),
                      .position = position,
                      .linearVelocity = velocity,
                      .angularVelocity = angular,
                      .mass = 1,
                      .inertia = {i, i, i},
                      .mask = 0});
}

// A turntable that turns about z at this rate.
struct Turntable {
    static constexpr double kRate = 6;  // rad/s
    TestWorld world{Weightless()};
    BodyId table = world.Add(
        {.shape = CubeOf(0.1f), .motion = MotionType::Kinematic, .angularVelocity = {0, 0, static_cast<float>(kRate)}});
};

// A bead on a wire or on a plane through the axis of a turntable flies outwards: r'' = w^2 r, so that r = r0 cosh(w t)
// where it begins at rest on the table. Its place in the world turns with the table.
TEST(GuidedMotion, BeadsFlyOutwardsOnATurntable) {
    constexpr double kStart = 0.2, kSeconds = 0.4;
    using enum JointAxis;
    for (const bool isWire : {true, false}) {
        Turntable turntable;
        TestWorld& world = turntable.world;
        const BodyId bead = AddBall(world, {kStart, 0, 0}, Vector3(0, static_cast<float>(6 * kStart), 0), {0, 0, 0});
        const JointSettings between = UprightBetween(turntable.table, bead, {kStart, 0, 0});
        const JointId joint =
            Join(world, isWire ? SixDofOf(between, {LinearY, LinearZ}) : SixDofOf(between, {LinearY}));
        double gap = 0;
        for (int i = 0; i < std::lround(kSeconds / kStep); ++i) {
            world.Step();
            gap = std::max(gap, std::fabs(JointsOf(world).GetCoordinate(joint, LinearY)));
        }
        const double expected = kStart * std::cosh(Turntable::kRate * kSeconds);
        const Position at = world.PositionOf(bead);
        // A row acts along its direction at the start of a substep; lines act along that at its middle.
        EXPECT_NEAR(std::hypot(at.x(), at.y()) / expected, 1, isWire ? 1e-3 : 0.053);
        EXPECT_LT(gap, isWire ? 1e-4 : 0.011);
    }
}

// Two balls on a hinge through both centers, A tumbling and B spinning about the hinge's axis a. Nothing else acts, so
// that w_A . a and w_B . a stay; with L = I (w_A + w_B) constant, a' = w_A x a = L x a / 2 I: the axis precesses about
// L at |L| / 2 I.
TEST(GuidedMotion, AHingeOfTumblingBodiesPrecesses) {
    for (const bool isAlone : {true, false}) {
        TestWorld world(Weightless());
        const Vector3 ofA(-8, 5, 0), ofB(15, 5, 0);  // a = x at first
        const BodyId a = AddBall(world, {0, 0, 0}, {0, 0, 0}, ofA);
        const BodyId b = AddBall(world, {0, 0, 0}, {0, 0, 0}, ofB);
        const JointSettings between = UprightBetween(a, b, {0, 0, 0});
        using enum JointAxis;
        const JointId joint =
            isAlone ? Join(world, SixDofOf(between, {AngularY, AngularZ})) : Join(world, HingeJointSettings{between});
        const Position l = (Vector3(ofA + ofB) * 0.5f).cast<double>();  // L / 2 I
        const double rate = std::sqrt(l.squaredNorm());
        double gap = 0;
        for (int i = 1; i <= 60; ++i) {
            world.Step();
            gap = std::max(gap, double{JointsOf(world).GetError(joint).angle});
        }
        // a turned about L by the angle.
        const Vector3 expected = Rotate(RotationAbout((l * (1 / rate)).cast<float>(), rate), Vector3(1, 0, 0));
        const Vector3 axis = Rotate(world.Bodies().GetPose(a).rotation, Vector3(1, 0, 0));
        const Vector3 wA = world.Bodies().GetAngularVelocity(a), wB = world.Bodies().GetAngularVelocity(b);
        EXPECT_LT(Length(Vector3(axis - expected)), 2e-3f);
        EXPECT_LT(gap, 2e-4);
        EXPECT_NEAR(Dot(wA, axis), ofA.x(), 0.01);
        EXPECT_NEAR(Dot(wB, axis), ofB.x(), 0.01);
        EXPECT_NEAR((LengthSquared(wA) + LengthSquared(wB)) / (LengthSquared(ofA) + LengthSquared(ofB)), 1, 1e-3);
    }
}

// A ball that is held at its center at the edge of a cone: only torques across its axis act, so that the axis moves on
// the unit sphere like a point that slides along the inside of the edge, at constant speed.
TEST(GuidedMotion, AnAxisSlidesAlongTheEdgeOfACone) {
    constexpr double kHalfAngle = 0.8, kSpeed = 5;
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const Quaternion start = RotationAbout({0, 1, 0}, kHalfAngle);
    // The axis moves along y: w is across both, in the plane of x and z.
    const Vector3 axis = Rotate(start, Vector3(1, 0, 0)), w = Cross(axis, Vector3(0, static_cast<float>(kSpeed), 0));
    const BodyId ball = AddBall(world, {0, 0, 0}, {0, 0, 0}, w);
    ConeJointSettings settings = Of<ConeJointSettings>(UprightBetween(hook, ball, {0, 0, 0}));
    settings.anchorB = AnchorAt({0, 0, 0}, axis);
    settings.halfAngle = static_cast<float>(kHalfAngle);
    Join(world, settings);
    double off = 0;
    for (int i = 1; i <= 60; ++i) {
        world.Step();
        const Vector3 now = Rotate(world.Bodies().GetPose(ball).rotation, axis);
        off = std::max(off, std::fabs(std::acos(double{now.x()}) - kHalfAngle));
        if (i == 20) {
            const double azimuth = std::atan2(double{now.y()}, -double{now.z()}),
                         expected = kSpeed / std::sin(kHalfAngle) * i * kStep;
            EXPECT_LT(std::fabs(std::remainder(azimuth - expected, 2 * kPi)), 0.03);
        }
    }
    EXPECT_LT(off, 1e-3);
    EXPECT_NEAR(Length(world.Bodies().GetAngularVelocity(ball)), kSpeed, 0.05 * kSpeed);
}

// A rod between points off the centers of two balls that spin.
TEST(GuidedMotion, ARodBetweenSpinningBodiesKeepsItsLength) {
    TestWorld world(Weightless());
    const BodyId a = AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 8});
    const BodyId b = AddBall(world, {1, 0, 0}, {0, 0, 0}, {3, 0, -9});
    DistanceJointSettings settings = Of<DistanceJointSettings>(Between(a, b, {0, 0.2, 0}));
    settings.anchorB = AnchorAt({1, 0.3, 0.1});
    const JointId rod = Join(world, settings);
    double gap = 0;
    const auto energy = [&] { return double{world.Bodies().GetKineticEnergy(a) + world.Bodies().GetKineticEnergy(b)}; };
    world.Step();  // takes what parts the ends
    const double first = energy();
    for (int i = 0; i < 60; ++i) {
        world.Step();
        gap = std::max(gap, double{JointsOf(world).GetError(rod).distance});
    }
    EXPECT_LT(gap, 2e-5);
    EXPECT_NEAR(energy() / first, 1, 1e-3);
}

// What flies to the end of a slider, a rope or a hinge within a step is there after it, and stands.
TEST(GuidedMotion, LimitsAreReachedExactly) {
    for (const int kind : {0, 1, 2}) {
        TestWorld world(Weightless());
        const BodyId hook = AddHook(world);
        const bool isTurn = kind == 2;
        const BodyId ball = AddBall(world, {isTurn ? 0.0 : 1.0, 0, 0}, Vector3(isTurn ? 0.0f : 3.0f, 0, 0),
                                    Vector3(isTurn ? 3.0f : 0.0f, 0, 0));
        const JointSettings between = Between(hook, ball, {0, 0, 0});
        JointId joint;
        constexpr double kWay = 0.03;
        if (kind == 0) {
            SliderJointSettings settings{between};
            settings.slide = Limited(-1, kWay);
            joint = Join(world, settings);
        } else if (kind == 1) {
            DistanceJointSettings settings = Of<DistanceJointSettings>(between);
            settings.anchorB = AnchorAt({1, 0, 0});
            settings.minDistance = 0.0f;
            settings.maxDistance = static_cast<float>(1 + kWay);
            joint = Join(world, settings);
        } else {
            HingeJointSettings settings{between};
            settings.angle = Limited(-1, kWay);
            joint = Join(world, settings);
        }
        world.Step();
        const double way =
            isTurn ? JointsOf(world).GetCoordinate(joint, JointAxis::AngularX) : world.PositionOf(ball).x() - 1;
        const double speed = double{world.VelocityOf(ball).x() + world.Bodies().GetAngularVelocity(ball).x()};
        EXPECT_NEAR(way, kWay, 1e-6) << kind;
        EXPECT_NEAR(speed, 0, 1e-5) << kind;
    }
}

// A chain of three bodies, from a base on, that bears a force and a torque along these axes on each of its bodies: each
// joint reads what those behind it bear. Once iterations have found that, nothing else moves, whatever the base does.
struct Load {
    std::string name;
    std::initializer_list<JointAxis> locked;
    Vector3 force, torque;            // unit or zero
    AxisControl first = kLockedAxis;  // of the first of these axes
    double motorSpeed = 0;
};

void ExpectCarried(const Load& load, double speed) {
    constexpr double kLoad = 10;  // N, N m
    TestWorld world(Weightless());
    const auto along = [&](const Vector3& axis, size_t i) {
        return Vector3(axis * static_cast<float>(speed + load.motorSpeed * static_cast<double>(i)));
    };
    const BodyId base = world.Add({.shape = SphereOf(0.05f),
                                   .motion = MotionType::Kinematic,
                                   .linearVelocity = along(load.force, 0),
                                   .angularVelocity = along(load.torque, 0)});
    std::array<BodyId, 3> bodies;
    std::array<JointId, 3> joints;
    for (size_t i = 0; i < 3; ++i) {
        bodies[i] = AddBall(world, {0, 0, 0}, along(load.force, i + 1), along(load.torque, i + 1));
        SixDofJointSettings settings =
            SixDofOf(UprightBetween(i == 0 ? base : bodies[i - 1], bodies[i], {0, 0, 0}), load.locked);
        settings[*load.locked.begin()] = load.first;
        joints[i] = Join(world, settings);
    }
    for (int i = 0; i < 60; ++i) {
        for (const BodyId body : bodies) {
            EXPECT_TRUE(world.Bodies().AddForce(body, load.force * static_cast<float>(kLoad)));
            EXPECT_TRUE(world.Bodies().AddTorque(body, load.torque * static_cast<float>(kLoad)));
        }
        world.Step();
    }
    for (size_t i = 0; i < 3; ++i) {
        const std::string name = load.name + ", " + std::to_string(speed) + ", " + std::to_string(i);
        const JointError error = JointsOf(world).GetError(joints[i]);
        EXPECT_LT(std::max(error.distance, error.angle), 1e-5f) << name;
        const Vector3 v = world.VelocityOf(bodies[i]), w = world.Bodies().GetAngularVelocity(bodies[i]);
        EXPECT_LT(Length(Vector3(v - along(load.force, i + 1))), 1e-5f) << name;
        EXPECT_LT(Length(Vector3(w - along(load.torque, i + 1))), 1e-5f) << name;
        const auto expected = static_cast<float>(-kLoad * static_cast<double>(3 - i));
        const Vector3 force = JointsOf(world).GetForce(joints[i]), torque = JointsOf(world).GetTorque(joints[i]);
        EXPECT_LT(Length(Vector3(force - load.force * expected)), 1e-3f) << name;
        EXPECT_LT(Length(Vector3(torque - load.torque * expected)), 1e-3f) << name;
    }
}

TEST(GuidedMotion, ChainsCarryLoads) {
    using enum JointAxis;
    const Vector3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), none(0, 0, 0);
    const AxisControl end = Limited(-1, 0), up{.motor = SpeedMotor(-1)}, down{.motor = SpeedMotor(1)};
    const Load loads[] = {
        {"row", {LinearX}, x, none},
        {"line", {LinearX, LinearY}, x, none},
        {"point", {LinearX, LinearY, LinearZ}, x, none},
        {"angle", {AngularX}, none, x},
        {"hinge rotation", {AngularX, AngularY}, none, y},
        {"rotation", {AngularX, AngularY, AngularZ}, none, y},
        {"fixed", {LinearX, LinearY, LinearZ, AngularX, AngularY, AngularZ}, x, y},
        {"hinge", {LinearX, LinearY, LinearZ, AngularY, AngularZ}, x, y},
        {"slider", {LinearX, LinearY, AngularX, AngularY, AngularZ}, x, z},
        {"end of a way", {LinearX}, x, none, end},
        {"end of a turn", {AngularX}, none, x, end},
        {"motor up", {LinearX}, x, none, up, -1},
        {"motor down", {LinearX}, x, none, down, 1},
        {"motor that turns up", {AngularX}, none, x, up, -1},
        {"motor that turns down", {AngularX}, none, x, down, 1},
    };
    for (const double speed : {-2.0, 0.0, 2.0})
        for (const Load& load : loads) ExpectCarried(load, speed);
}

// A motor towards a hard limit slows down so as to be there a substep after the step.
TEST(GuidedMotion, MotorsStopAtLimits) {
    constexpr double kWay = 0.03;
    using enum JointAxis;
    for (const JointAxis axis : {LinearX, AngularX})
        for (const bool isSingle : {true, false})
            for (const double sign : {1.0, -1.0}) {
                if (axis == LinearX && !isSingle) continue;
                TestWorld world(Weightless());
                const BodyId ball = AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
                const JointSettings between = UprightBetween(AddHook(world), ball, {0, 0, 0});
                AxisControl control = Limited(-kWay, kWay);
                control.motor = SpeedMotor(3 * sign);
                const JointId joint = Join(world, Guided(between, axis, isSingle, control));
                const double h = kStep / world.System().Settings().solver.substeps;
                world.Step();
                EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, axis), sign * kWay * kStep / (kStep + h), 1e-5)
                    << static_cast<int>(axis) << " " << isSingle << " " << sign;
            }
}

// Motors push no harder than they may, either way: v = F t / m.
TEST(GuidedMotion, WeakMotorsAccelerateByTheirForce) {
    using enum JointAxis;
    constexpr double kForce = 0.3, kLess = 0.2;  // N, N m
    for (const JointAxis axis : {LinearX, AngularX})
        for (const bool isSingle : {true, false})
            for (const bool isPosition : {true, false})
                for (const double sign : {1.0, -1.0}) {
                    if (axis == LinearX && !isSingle) continue;
                    TestWorld world(Weightless());
                    const BodyId ball = AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
                    JointMotor motor =
                        isPosition ? PositionMotor(2 * sign, FrequencySpring(5, 1)) : SpeedMotor(100 * sign);
                    motor.minForce = static_cast<float>(-kLess);
                    motor.maxForce = static_cast<float>(kForce);
                    Join(world, Guided(UprightBetween(AddHook(world), ball, {0, 0, 0}), axis, isSingle,
                                       AxisControl{.motor = motor}));
                    world.Steps(6);
                    const double v = double{axis == LinearX ? world.VelocityOf(ball).x()
                                                            : world.Bodies().GetAngularVelocity(ball).x()},
                                 inertia = axis == LinearX ? 1 : kInertia;
                    EXPECT_NEAR(v, (sign > 0 ? kForce : -kLess) * 6 * kStep / inertia, 1e-4)
                        << static_cast<int>(axis) << " " << isSingle << " " << isPosition << " " << sign;
                }
}

// Targets of swings beyond the limits are those at the limits.
TEST(GuidedMotion, SwingTargetsStayWithinTheLimits) {
    for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid}) {
        TestWorld world(Weightless());
        const BodyId ball = AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
        SwingTwistJointSettings settings = Of<SwingTwistJointSettings>(UprightBetween(AddHook(world), ball, {0, 0, 0}));
        settings.shape = shape;
        settings.swingY = settings.swingZ = Limited(-0.5, 0.5);
        settings.swingY.motor = PositionMotor(0.6, FrequencySpring(2, 1));
        settings.swingZ.motor = settings.twist.motor = PositionMotor(0, FrequencySpring(2, 1));
        const JointId joint = Join(world, settings);
        world.Run(3);
        EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::AngularY), 0.5, 1e-3) << static_cast<int>(shape);
    }
}

// A damped spring along a straight path, whose locks are rows.
TEST(GuidedMotion, ASpringAlongAPathIsAnOscillator) {
    TestWorld world(Weightless());
    const BodyId ball = AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    PathJointSettings settings = Of<PathJointSettings>(UprightBetween(AddHook(world), ball, {0, 0, 0}));
    settings.rotation = PathRotation::TangentAndNormal;
    settings.along.motor = PositionMotor(0.7, FrequencySpring(2, 0.2));  // it begins at the middle, 0.5
    const JointId joint = Join(world, settings);
    std::vector<double> away;
    for (int i = 0; i < 60; ++i) {
        world.Step();
        away.push_back(JointsOf(world).GetCoordinate(joint, JointAxis::LinearX) - double{0.7f});
    }
    const Oscillator found = FitOscillator(away, kStep, 5);
    EXPECT_NEAR(found.frequency, 2, 0.01);
    EXPECT_NEAR(found.dampingRatio, 0.2, 0.002);
}

// A hinge counts the turns of a base that turns by more than a turn in a step, under a load that stands still.
TEST(GuidedMotion, AHingeCountsTheTurnsOfItsBase) {
    constexpr double kRate = 450;  // rad/s
    TestWorld world(Weightless());
    const BodyId base = world.Add({.shape = CubeOf(0.1f),
                                   .motion = MotionType::Kinematic,
                                   .angularVelocity = {static_cast<float>(kRate), 0, 0},
                                   .maxAngularSpeed = 1000});
    HingeJointSettings settings{Between(base, AddBall(world, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}), {0, 0, 0})};
    settings.angle = Limited(-1e6, 1e6);
    const JointId hinge = Join(world, settings);
    for (int i = 1; i <= 20; ++i) {
        world.Step();
        EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), -kRate * i * kStep, 0.01) << i;
    }
}

}  // namespace
}  // namespace fulcrum::testing
