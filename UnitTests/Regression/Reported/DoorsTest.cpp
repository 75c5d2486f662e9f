// Reported of hinges elsewhere: doors that a first push hardly moves, pivots far from their body, motors to angles of a
// quarter turn and more, limits of half a turn and more. Each against its closed form.
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

HingeJointSettings HingeOf(BodyId a, BodyId b, const Vector3& axis) {
    HingeJointSettings hinge;
    hinge.bodyA = a;
    hinge.bodyB = b;
    hinge.anchorA.axis = axis;
    return hinge;
}

SystemSettings Floating() {
    SystemSettings settings = NoGravity();
    settings.sleep.enabled = false;
    return settings;
}

// An angular impulse J about the hinge gives a door the speed J / (I + m d2), in any orientation, of a new world and of
// one at rest. The hinge's error in the angle after three steps, some 1e-3 of the arm, and the rounding of the masses
// are far below 1 %.
TEST(Doors, TurnAtOnceAsTheirInertiaSays) {
    const float mass = 20, arm = 0.55f, push = 3;
    const Vector3 half(0.5f, 1, 0.04f);
    const double inertia = mass * (half.x() * half.x() + half.z() * half.z()) / 3.0 + mass * arm * arm;
    RandomPoses random(1);
    for (int i = 0; i < 24; ++i) {
        const Quaternion turned = i < 8 ? RotationAbout({0, 1, 0}, i * kPi / 4) : random.Rotation();
        TestWorld world(NoGravity());
        const BodyId post = world.Add({.shape = BoxOf(0.05f, 1, 0.05f), .motion = MotionType::Static}),
                     door = world.Add({.shape = BoxOf(half.x(), half.y(), half.z()),
                                       .position = Rotate(turned, Vector3(arm, 0, 0)).cast<double>(),
                                       .rotation = turned,
                                       .mass = mass});
        const Vector3 up = Rotate(turned, Vector3(0, 1, 0));
        ASSERT_TRUE(world.System().Joints().Create(HingeOf(post, door, up)));
        world.Steps(i % 3 == 0 ? 0 : i % 3 == 1 ? 12 : 60);
        const float sign = i % 2 ? 1.0f : -1.0f;
        ASSERT_TRUE(world.Bodies().AddAngularImpulse(door, up * (sign * push)));
        world.Steps(3);
        const double speed = Dot(world.Bodies().GetAngularVelocity(door), up) * sign;
        EXPECT_NEAR(speed / (push / inertia), 1, 0.01) << "door " << i;
    }
}

// A compound pendulum with a pivot d from its center, beyond its shape: T = 2 pi sqrt(I / (m g d)) (1 + a2 / 16) for
// the amplitude a. Two balls of radius r at +-e have I / m = 2/5 r2 + e2 + d2. The time of crossing is interpolated
// linearly within a step, which is off by less than dt2 / T; five periods bound it by 1e-3.
TEST(Doors, APivotFarAwayIsThatOfAPendulum) {
    const double amplitude = 0.1, radius = 0.1, offset = 0.5;
    for (const double distance : {2.0, 10.0}) {
        TestWorld world;
        const BodyId body = world.Add({.shape = CompoundOf({{.shape = SphereOf(0.1f), .position = {-0.5f, 0, 0}},
                                                            {.shape = SphereOf(0.1f), .position = {0.5f, 0, 0}}}),
                                       .position = {distance * std::sin(amplitude), -distance * std::cos(amplitude), 0},
                                       .rotation = RotationAbout({0, 0, 1}, amplitude)});
        ASSERT_TRUE(world.System().Joints().Create(HingeOf(kWorldBody, body, {0, 0, 1})));
        const double inertia = 0.4 * radius * radius + offset * offset + distance * distance,
                     period = 2 * kPi * std::sqrt(inertia / (kGravity * distance)) * (1 + amplitude * amplitude / 16);
        double last = 1, first = 0, end = 0;
        int crossings = 0;
        for (int step = 1; step < 5 * period / kStep; ++step) {
            world.Step();
            const double x = world.PositionOf(body).x();
            if (x < 0 && last >= 0) {
                end = kStep * (step - x / (x - last));
                if (crossings++ == 0) first = end;
            }
            last = x;
        }
        ASSERT_GE(crossings, 4);
        EXPECT_NEAR((end - first) / (crossings - 1) / period, 1, 0.003) << distance;
    }
}

// A critically damped spring of 2 Hz leaves (1 + w t) e^(-w t) of the way after t: 2e-5 after a second, of up to 17
// rad.
TEST(Doors, AMotorTurnsToAnyAngle) {
    for (const int degrees : {-170, -90, -45, 45, 89, 90, 91, 135, 179, 181, 270, 450, -1000})
        for (int axis = 0; axis < 3; ++axis) {
            TestWorld world(Floating());
            const BodyId body = world.Add({.shape = BoxOf(0.5f, 0.1f, 0.2f), .position = {0.4, 0, 0}});
            HingeJointSettings hinge = HingeOf(kWorldBody, body, Vector3::Unit(axis));
            const auto angle = static_cast<float>(degrees * kDegree);
            hinge.angle.motor = {
                .mode = MotorMode::ToPosition, .targetPosition = angle, .spring = {.frequency = 2, .dampingRatio = 1}};
            const JointId joint = world.System().Joints().Create(hinge).Value();
            world.Steps(90);
            EXPECT_NEAR(world.System().Joints().GetCoordinate(joint, JointAxis::AngularX), angle, 0.005)
                << degrees << " degrees, axis " << axis;
        }
}
TEST(Doors, AMotorOfASixDofTurnsToAnyAngleBelowHalfATurn) {
    for (const int degrees : {-170, -135, -90, -45, 45, 90, 135, 170})
        for (int axis = 0; axis < 3; ++axis) {
            TestWorld world(Floating());
            SixDofJointSettings joint;
            joint.bodyA = kWorldBody;
            joint.bodyB = world.Add({.shape = BoxOf(0.5f, 0.1f, 0.2f), .position = {0.4, 0, 0}});
            const size_t driven = 3 + static_cast<size_t>(axis);
            for (size_t k = 0; k < 6; ++k) joint.axes[k].limited = k != driven;
            const auto angle = static_cast<float>(degrees * kDegree);
            joint.axes[driven].motor = {
                .mode = MotorMode::ToPosition, .targetPosition = angle, .spring = {.frequency = 2, .dampingRatio = 1}};
            const Result<JointId> id = world.System().Joints().Create(joint);
            ASSERT_TRUE(id) << id.GetError().message;
            world.Steps(90);
            EXPECT_NEAR(world.System().Joints().GetCoordinate(id.Value(), static_cast<JointAxis>(driven)), angle, 0.005)
                << degrees << " degrees, axis " << axis;
        }
}

// A bar under a torque turns to its limit, however many turns away, and no further. It arrives with up to
// sqrt(2 M a / I) = 6 rad/s for a turn and a half, a tenth of a radian a step: a limit stops it within a substep of
// four.
TEST(Doors, LimitsOfAnyAngleStopThem) {
    for (const int degrees : {60, 90, 175, 180, 185, 270, 360, 540})
        for (const int sign : {-1, 1}) {
            TestWorld world(Floating());
            const BodyId body = world.Add({.shape = BoxOf(0.5f, 0.1f, 0.2f), .position = {0.4, 0, 0}});
            HingeJointSettings hinge = HingeOf(kWorldBody, body, {0, 0, 1});
            const auto limit = static_cast<float>(degrees * kDegree);
            hinge.angle.limited = true;
            hinge.angle.limits.min = sign < 0 ? -limit : -0.1f;
            hinge.angle.limits.max = sign > 0 ? limit : 0.1f;
            const JointId joint = world.System().Joints().Create(hinge).Value();
            double most = 0, angle = 0;
            for (int step = 0; step < 300; ++step) {
                ASSERT_TRUE(world.Bodies().AddTorque(body, {0, 0, static_cast<float>(sign * 40)}));
                world.Step();
                angle = sign * world.System().Joints().GetCoordinate(joint, JointAxis::AngularX);
                most = std::max(most, angle);
            }
            EXPECT_NEAR(angle, limit, 0.01) << degrees << " degrees";
            EXPECT_LT(most, limit + 0.03) << degrees << " degrees";
        }
}

}  // namespace
}  // namespace fulcrum::testing
