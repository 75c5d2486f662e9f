// Cones and swing-twist limits from 0 to 180 degrees: bodies thrown about stay within, and nothing else is held.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A row keeps its axis for a step of 1/60 s: turning across it by an angle s in that time widens the swing by s^2 / 2
// tan(limit) at most. s is 0.1 at 6 rad/s, about as fast as the bodies are here; 0.011 rad for what limits leak, and
// for wide ones.
double Overshoot(double limit) { return 0.011 + 0.1 * 0.1 / (2 * std::max(std::tan(std::min(limit, kPi / 4)), 0.1)); }

class Cone : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Degrees, Cone, ::testing::Values(0, 1, 10, 45, 90, 135, 170, 179, 180));

double AngleBetween(const Vector3& a, const Vector3& b) {
    return std::atan2(double(Length(Cross(a, b))), double(Dot(a, b)));
}
Vector3 AxisOfBody(TestWorld& world, BodyId id) {
    return Rotate(world.Bodies().GetPose(id).rotation, Vector3(1, 0, 0));
}

TEST_P(Cone, ABodyThatIsThrownAboutStaysWithin) {
    const double limit = GetParam() * kDegree;
    for (const bool fromTheEnd : {false, true}) {
        TestWorld world(NoSleep());
        const Position center = fromTheEnd ? Position(0.5, 0, 0) : Position(0, 0, 0);
        const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.3f, 0.3f), .position = center, .mass = 2});
        ConeJointSettings settings{Between(AddHook(world), rod, {0, 0, 0})};
        settings.halfAngle = static_cast<float>(limit);
        const JointId cone = Join(world, settings);
        uint32_t random = 7;
        const auto number = [&] {
            return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 8388608.0f - 1;
        };
        double widest = 0, gap = 0;
        Vector3 torque = Vector3::Zero();
        for (int i = 0; i < 900; ++i) {
            const float x = number(), y = number(), z = number();
            // Torques that change every quarter of a second; drag keeps the speeds at some radians a second.
            if (i % 15 == 0) torque = Vector3(x, y, z) * 3.0f;
            ASSERT_TRUE(world.Bodies().AddTorque(rod, Vector3(torque - world.Bodies().GetAngularVelocity(rod) * 0.4f)));
            world.Step();
            widest = std::max(widest, AngleBetween(Vector3(1, 0, 0), AxisOfBody(world, rod)));
            gap = std::max(gap, double(JointsOf(world).GetError(cone).distance));
        }
        EXPECT_LE(widest, limit + Overshoot(limit));
        EXPECT_LT(gap, 2e-3);
        EXPECT_TRUE(world.AllFinite());
        // From the end of the rod gravity pulls it down by 90 degrees or to the limit.
        if (fromTheEnd) {
            EXPECT_GE(widest, std::min(limit, kPi / 2) - 0.02);
        }
    }
}

TEST_P(Cone, SpinIsFree) {
    TestWorld world(Weightless());
    const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .angularVelocity = {20, 0, 0}, .mass = 2});
    ConeJointSettings settings{Between(AddHook(world), rod, {0, 0, 0})};
    settings.halfAngle = static_cast<float>(GetParam() * kDegree);
    Join(world, settings);
    world.Run(3);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(rod).x(), 20, 0.02);
}

TEST(Cone, ARodLeansOnItsEdge) {
    TestWorld world(NoSleep());
    const BodyId rod =
        world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 2, .angularDamping = 2});
    ConeJointSettings settings{Between(AddHook(world), rod, {0, 0, 0})};
    settings.halfAngle = static_cast<float>(30 * kDegree);
    const JointId cone = Join(world, settings);
    world.Run(5);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(cone, JointAxis::AngularY), 30 * kDegree, 1e-3);
    EXPECT_NEAR(world.PositionOf(rod).y(), -0.5 * std::sin(30 * kDegree), 1e-3);
}

struct SwingCase {
    SwingShape shape;
    double y, z, twist;  // degrees
    friend std::ostream& operator<<(std::ostream& out, const SwingCase& c) {
        return out << (c.shape == SwingShape::Ellipse ? "ellipse " : "pyramid ") << c.y << ", " << c.z << ", twist "
                   << c.twist;
    }
};

class SwingTwistLimit : public ::testing::TestWithParam<SwingCase> {};

constexpr auto kE = SwingShape::Ellipse, kP = SwingShape::Pyramid;
INSTANTIATE_TEST_SUITE_P(Shapes, SwingTwistLimit,
                         ::testing::Values(SwingCase{kE, 30, 30, 20}, SwingCase{kE, 60, 20, 45},
                                           SwingCase{kE, 10, 120, 90}, SwingCase{kE, 5, 5, 5},
                                           SwingCase{kE, 150, 90, 170}, SwingCase{kE, 170, 170, 180},
                                           SwingCase{kE, 180, 40, 30}, SwingCase{kE, 180, 180, 30},
                                           SwingCase{kE, 0, 60, 30}, SwingCase{kE, 0, 0, 60}, SwingCase{kE, 45, 45, 0},
                                           SwingCase{kP, 30, 30, 20}, SwingCase{kP, 60, 20, 45},
                                           SwingCase{kP, 120, 30, 90}, SwingCase{kP, 150, 90, 170},
                                           SwingCase{kP, 180, 40, 30}, SwingCase{kP, 180, 180, 30},
                                           SwingCase{kP, 0, 60, 30}, SwingCase{kP, 45, 45, 0}));

// How far the rotation vector (0, y, z) of the swing is beyond its limits, rad.
double Beyond(const SwingCase& c, double y, double z) {
    const double a = c.y * kDegree, b = c.z * kDegree, angle = std::hypot(y, z);
    if (c.y == 180 && c.z == 180) return 0;
    // With one axis free the other one limits the latitude that x is turned to.
    if (c.y == 180) return std::fabs(std::asin(std::sin(angle) * z / angle)) - b;
    if (c.shape == kP) {
        // The faces of the pyramid: tan(phi_y / 2) and tan(phi_z / 2) of the components of the quaternion.
        const double tangent = std::tan(angle / 2) / angle;
        return std::max(2 * std::atan(std::fabs(y) * tangent) - a, 2 * std::atan(std::fabs(z) * tangent) - b);
    }
    if (c.y == 0 || c.z == 0) return std::max(std::fabs(y) - a, std::fabs(z) - b);
    if (y * y / (a * a) + z * z / (b * b) <= 1) return 0;
    double nearest = 9;
    for (int i = 0; i < 720; ++i)
        nearest = std::min(nearest, std::hypot(y - a * std::cos(i * kDegree / 2), z - b * std::sin(i * kDegree / 2)));
    return nearest;
}

TEST_P(SwingTwistLimit, ABodyThatIsThrownAboutStaysWithin) {
    const SwingCase& c = GetParam();
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 10});  // I = 1
    SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
    settings.shape = c.shape;
    settings.twist = Limited(-c.twist * kDegree, c.twist * kDegree);
    settings.swingY = Limited(-c.y * kDegree, c.y * kDegree);
    settings.swingZ = Limited(-c.z * kDegree, c.z * kDegree);
    for (AxisControl* axis : {&settings.twist, &settings.swingY, &settings.swingZ})
        for (float* end : {&axis->limits.min, &axis->limits.max}) *end = std::clamp(*end, -3.14159265f, 3.14159265f);
    const JointId joint = Join(world, settings);
    uint32_t random = 99;
    const auto number = [&] {
        return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 8388608.0f - 1;
    };
    double swing = 0, twist = 0;
    Vector3 torque = Vector3::Zero();
    for (int i = 0; i < 1200; ++i) {
        const float x = number(), y = number(), z = number();
        if (i % 30 == 0) torque = Vector3(x, y, z) * 6.0f;
        ASSERT_TRUE(world.Bodies().AddTorque(ball, Vector3(torque - world.Bodies().GetAngularVelocity(ball))));
        world.Step();
        const double ofY = JointsOf(world).GetCoordinate(joint, JointAxis::AngularY),
                     ofZ = JointsOf(world).GetCoordinate(joint, JointAxis::AngularZ);
        swing = std::max(swing, Beyond(c, ofY, ofZ));
        // Twist means nothing where the axis points back.
        if (std::hypot(ofY, ofZ) < 3.0)
            twist = std::max(twist,
                             std::fabs(JointsOf(world).GetCoordinate(joint, JointAxis::AngularX)) - c.twist * kDegree);
    }
    EXPECT_LE(swing, Overshoot(std::min(c.y, c.z) * kDegree));
    EXPECT_LE(twist, 0.02);
    EXPECT_TRUE(world.AllFinite());
    EXPECT_LT(Length(world.Bodies().GetAngularVelocity(ball)), 20);
}

TEST(SwingTwist, AMotorTurnsToAnOrientationTheShortestWay) {
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 10});
    SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
    for (AxisControl* axis : {&settings.twist, &settings.swingY, &settings.swingZ})
        axis->motor = PositionMotor(0, FrequencySpring(2, 1));
    const JointId joint = Join(world, settings);
    for (const Quaternion target :
         {RotationAbout({0, 0, 1}, 1.2), Normalized(RotationAbout({0, 1, 0}, 0.8) * RotationAbout({1, 0, 0}, -1.0)),
          RotationAbout({0.6f, 0, 0.8f}, 3.0)}) {
        ASSERT_TRUE(JointsOf(world).SetTargetOrientation(joint, target));
        world.Run(4);
        // Frame and body axes are the same here.
        const Quaternion left = target.Conjugate() * world.Bodies().GetPose(ball).rotation;
        EXPECT_LT(2 * std::sqrt(left.x * left.x + left.y * left.y + left.z * left.z), 2e-3);
        EXPECT_LT(Length(world.Bodies().GetAngularVelocity(ball)), 1e-3);
    }
}

TEST(SwingTwist, ASpeedMotorTurnsAboutEachAxis) {
    for (int axis = 0; axis < 3; ++axis) {
        TestWorld world(Weightless());
        const BodyId ball = world.Add({.shape = SphereOf(0.5f), .mass = 10});
        SwingTwistJointSettings settings{UprightBetween(AddHook(world), ball, {0, 0, 0})};
        AxisControl* const controls[] = {&settings.twist, &settings.swingY, &settings.swingZ};
        controls[axis]->motor = SpeedMotor(2, 4);
        Join(world, settings);
        // I = 1: half a second to 2 rad/s.
        world.Run(0.25);
        EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball)[axis], 1, 1e-3);
        world.Run(1);
        EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball)[axis], 2, 1e-3);
    }
}

}  // namespace
}  // namespace fulcrum::testing
