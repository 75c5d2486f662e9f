// What moves slowly is not put to sleep: what a motor, a force or gravity still drives, however slowly, and what moves
// on faster than sleep allows. Against closed forms, at several lengths and divisions of the step. And what is as slow
// but at rest, which is.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>
#include <ostream>

namespace fulcrum::testing {
namespace {

struct Pace {
    double dt = kStep;
    int substeps = 4;
    uint32_t threads = 1;
};
const Pace kPaces[] = {
    {}, {.threads = 2}, {.dt = 1.0 / 30}, {.dt = 1.0 / 240}, {.substeps = 1}, {.substeps = 2}, {.substeps = 16}};

std::ostream& operator<<(std::ostream& out, const Pace& pace) {
    return out << 1 / pace.dt << " Hz, " << pace.substeps << " substeps, " << pace.threads << " threads";
}

struct SlowWorld : TestWorld {
    explicit SlowWorld(const Pace& itsPace, double gravity = kGravity)
        : TestWorld(SettingsOf(itsPace, gravity), itsPace.threads), pace(itsPace) {}

    void Go(double seconds) { Run(seconds, pace.dt); }
    double Coordinate(JointId joint, JointAxis axis) { return JointsOf(*this).GetCoordinate(joint, axis); }

    static SystemSettings SettingsOf(const Pace& pace, double gravity) {
        SystemSettings settings;
        settings.solver.substeps = pace.substeps;
        settings.gravity = Vector3(0, static_cast<float>(-gravity), 0);
        return settings;
    }
    const Pace pace;
};

// ---- Driven by motors

TEST(SlowMotor, TurnsTheHandsOfAClock) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace);
        const double periods[] = {60, 3600, 43200};
        JointId joints[3];
        for (int i = 0; i < 3; ++i) {
            const BodyId hand = world.Add({.shape = BoxOf(0.15f, 0.01f, 0.01f), .position = {0.15, 2, 1.0 * i}});
            HingeJointSettings hinge{Between(kWorldBody, hand, {0, 2, 1.0 * i}, {0, 0, 1})};
            hinge.angle.motor = SpeedMotor(2 * kPi / periods[i]);
            joints[i] = Join(world, hinge);
        }
        world.Go(20);
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(world.Coordinate(joints[i], JointAxis::AngularX) / (2 * kPi) * periods[i], 20, 0.2)
                << pace << ", " << periods[i] << " s";
    }
}

TEST(SlowMotor, LiftsAGate) {
    for (const Pace& pace : kPaces)
        for (const double speed : {0.02, 0.0005}) {
            SlowWorld world(pace);
            const BodyId gate = world.Add({.shape = BoxOf(1, 1, 0.1f), .position = {5, 2, 0}});
            SliderJointSettings slider{Between(kWorldBody, gate, {5, 2, 0}, {0, 1, 0})};
            slider.slide.motor = SpeedMotor(speed);
            const JointId joint = Join(world, slider);
            world.Go(20);
            EXPECT_NEAR(world.Coordinate(joint, JointAxis::LinearX), 20 * speed, 0.2 * speed) << pace;
        }
}

TEST(SlowMotor, OfLittleForceAcceleratesWhatIsHeavy) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace, 0);
        const BodyId load = world.Add({.shape = CubeOf(0.5f), .mass = 1000});
        SliderJointSettings slider{Between(kWorldBody, load, {0, 0, 0}, {0, 1, 0})};
        slider.slide.motor = SpeedMotor(1, 0.5);
        const JointId joint = Join(world, slider);
        world.Go(20);
        const double way = 0.5 * 0.5e-3 * 400;
        EXPECT_NEAR(world.Coordinate(joint, JointAxis::LinearX), way, 0.02 * way) << pace;
    }
}

// An overdamped spring closes by w / (2 zeta) of what is left a second.
TEST(SlowMotor, CreepsToItsPosition) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace);
        const BodyId door = world.Add({.shape = BoxOf(0.5f, 1, 0.02f), .position = {0.5, 1, 0}});
        HingeJointSettings hinge{Between(kWorldBody, door, {0, 1, 0}, {0, 1, 0})};
        hinge.angle.motor = PositionMotor(0.2, FrequencySpring(1, 50));
        const JointId joint = Join(world, hinge);
        world.Go(40);
        const double rate = 2 * kPi / 100;
        EXPECT_NEAR(world.Coordinate(joint, JointAxis::AngularX), 0.2 * (1 - std::exp(-40 * rate)), 0.001) << pace;
    }
}

TEST(SlowMotor, SwingsOnASlowSpring) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace, 0);
        const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {1.05, 0, 0}});
        DistanceJointSettings rod{Between(kWorldBody, ball, {0, 0, 0})};
        rod.anchorB = AnchorAt({1.05, 0, 0});
        rod.minDistance = rod.maxDistance = 1;
        rod.spring = FrequencySpring(0.05, 0, SpringForm::Exact);
        Join(world, rod);
        world.Go(10);  // half a period
        EXPECT_NEAR(world.PositionOf(ball).x(), 0.95, 0.002) << pace;
        world.Go(10);
        EXPECT_NEAR(world.PositionOf(ball).x(), 1.05, 0.002) << pace;
    }
}

// ---- Driven by forces and gravity

TEST(SmallForce, PushesABoxOnIce) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace);
        world.AddFloor({.friction = 0});
        const BodyId box =
            world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 10, .material = {.friction = 0}});
        for (int i = static_cast<int>(std::lround(20 / pace.dt)); i > 0; --i) {
            ASSERT_TRUE(world.Bodies().AddForce(box, {0.2f, 0, 0}));
            world.Step(pace.dt);
        }
        EXPECT_NEAR(world.VelocityOf(box).x(), 0.4, 0.008) << pace;
    }
}

TEST(SmallForce, OfGravityLetsABodyFall) {
    for (const Pace& pace : kPaces)
        for (const double gravity : {0.02, 1e-4}) {
            SlowWorld world(pace, gravity);
            const BodyId box = world.Add({.shape = CubeOf(0.5f)});
            world.Go(30);
            EXPECT_NEAR(-world.PositionOf(box).y() / (450 * gravity), 1, 0.02) << pace;
        }
}

// It sinks at g / c = 5 mm/s; damped after each step, by up to c dt = 0.67 of that less.
TEST(SmallForce, SinksThroughHoney) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace, 0.1);
        const BodyId ball = world.Add({.shape = SphereOf(0.1f), .linearDamping = 20});
        world.Go(20);
        EXPECT_GT(-world.PositionOf(ball).y(), 20 * 0.003) << pace;
        EXPECT_LT(-world.PositionOf(ball).y(), 20 * 0.005) << pace;
    }
}

TEST(SmallForce, IsNotNeededToDriftThroughSpace) {
    for (const Pace& pace : kPaces)
        for (const double speed : {0.03, 0.012}) {
            SlowWorld world(pace, 0);
            const auto v = static_cast<float>(speed);
            const BodyId drifts = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {v, 0, 0}});
            // Its corners are 0.71 m from the axis.
            const BodyId turns =
                world.Add({.shape = CubeOf(0.5f), .position = {5, 5, 0}, .angularVelocity = {0, 0, 1.5f * v}});
            world.Go(20);
            EXPECT_NEAR(world.PositionOf(drifts).x() / (20 * speed), 1, 1e-3) << pace;
            EXPECT_NEAR(world.Bodies().GetAngularVelocity(turns).z() / (1.5 * speed), 1, 1e-3) << pace;
        }
}

TEST(SmallForce, MovesAnAtwoodMachine) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace);
        const BodyId a = world.Add({.shape = SphereOf(0.2f), .position = {-1, 3, 0}, .mass = 100});
        const BodyId b = world.Add({.shape = SphereOf(0.2f), .position = {1, 3, 0}, .mass = 101});
        PulleyJointSettings pulley;
        pulley.bodyA = a;
        pulley.bodyB = b;
        pulley.anchorA.point = {-1, 3, 0};
        pulley.anchorB = AnchorAt({1, 3, 0});
        pulley.fixedPointA = {-1, 8, 0};
        pulley.fixedPointB = {1, 8, 0};
        Join(world, pulley);
        world.Go(6);
        const double way = 0.5 * kGravity / 201 * 36;
        EXPECT_NEAR(3 - world.PositionOf(b).y(), way, 0.05 * way) << pace;
    }
}

// A slope that rises along x by an angle, and a ball of radius 0.5 m on it.
BodyId AddBallOnSlope(TestWorld& world, double angle, float speed) {
    const Quaternion rotation = RotationAbout({0, 0, 1}, angle);
    world.Add({.shape = BoxOf(50, 1, 5),
               .motion = MotionType::Static,
               .position = Rotate(rotation, Vector3(0, -1, 0)).cast<double>(),
               .rotation = rotation});
    return world.Add({.shape = SphereOf(0.5f),
                      .position = Rotate(rotation, Vector3(0, 0.5f, 0)).cast<double>(),
                      .linearVelocity = {speed, 0, 0},
                      .angularVelocity = {0, 0, -2 * speed}});
}

TEST(SmallForce, RollsABallDown) {
    for (const Pace& pace : kPaces)
        for (const double degrees : {0.3, 0.1}) {
            SlowWorld world(pace);
            const BodyId ball = AddBallOnSlope(world, degrees * kDegree, 0);
            world.Go(10);
            const double way = 50 * 5.0 / 7 * kGravity * std::sin(degrees * kDegree);
            EXPECT_NEAR(-world.PositionOf(ball).x() / way, 1, 0.05) << pace << ", " << degrees;
        }
}

TEST(SmallForce, SwingsAPendulum) {
    for (const Pace& pace : kPaces)
        for (const double gravity : {0.02, 0.5}) {
            SlowWorld world(pace, gravity);
            // A rod about its end, 0.1 rad out. Its period lengthens by a sixteenth of the angle's square.
            const double angle = 0.1, period = 2 * kPi * std::sqrt(2.0 / 3 / gravity) * (1 + angle * angle / 16);
            const Quaternion rotation = RotationAbout({0, 0, 1}, angle);
            const BodyId rod = world.Add({.shape = BoxOf(0.01f, 0.5f, 0.01f),
                                          .position = Rotate(rotation, Vector3(0, -0.5f, 0)).cast<double>(),
                                          .rotation = rotation});
            const JointId joint = Join(world, HingeJointSettings{Between(kWorldBody, rod, {0, 0, 0}, {0, 0, 1})});
            world.Go(period / 2);
            EXPECT_NEAR(world.Coordinate(joint, JointAxis::AngularX), -2 * angle, 0.005) << pace << ", " << gravity;
            world.Go(period / 2);
            EXPECT_NEAR(world.Coordinate(joint, JointAxis::AngularX), 0, 0.005) << pace << ", " << gravity;
        }
}

// The angle grows as cosh(k t), k^2 = 3 g / 2 L for the rod on its hinge: in 4 s by 10^6.
TEST(SmallForce, TipsWhatBalances) {
    for (const Pace& pace : kPaces)
        for (const double angle : {1e-2, 1e-3})
            for (const bool isHinged : {true, false}) {
                SlowWorld world(pace);
                world.AddFloor({.friction = 5});
                const Quaternion rotation = RotationAbout({0, 0, 1}, angle);
                const Vector3 up = Rotate(rotation, Vector3(0, 1, 0));
                // On its round end a capsule is as unstable.
                const BodyId rod =
                    world.Add({.shape = isHinged ? BoxOf(0.01f, 0.5f, 0.01f) : CapsuleOf(0.48f, 0.02f),
                               .position = isHinged ? Position(up.cast<double>() * 0.5 + Position(0, 2, 0))
                                                    : Position(up.cast<double>() * 0.48 + Position(0, 0.02, 0)),
                               .rotation = rotation});
                if (isHinged) Join(world, HingeJointSettings{Between(kWorldBody, rod, {0, 2, 0}, {0, 0, 1})});
                double lowest = 1;
                for (int i = 0; i < 8; ++i) {
                    world.Go(0.5);
                    const Quaternion now = world.Bodies().GetPose(rod).rotation;
                    lowest = std::min(lowest, double(Rotate(now, Vector3(0, 1, 0)).y()));
                }
                EXPECT_LT(lowest, 0.5) << pace << ", " << angle << (isHinged ? ", hinged" : "");
            }
}

TEST(SmallForce, IsNotNeededToRollOn) {
    for (const Pace& pace : kPaces)
        for (const float speed : {0.03f, 0.012f}) {
            SlowWorld world(pace);
            const BodyId ball = AddBallOnSlope(world, 0, speed);
            world.Go(20);
            EXPECT_NEAR(world.PositionOf(ball).x() / (20 * double(speed)), 1, 0.02) << pace << ", " << speed;
        }
}

// ---- Carried

TEST(SlowLift, CarriesAStackAndLetsItSleepWhenItStops) {
    for (const Pace& pace : kPaces)
        for (const float speed : {0.01f, 0.0005f}) {
            SlowWorld world(pace);
            const BodyId lift = world.Add(
                {.shape = BoxOf(2, 0.5f, 2), .motion = MotionType::Kinematic, .linearVelocity = {0, speed, 0}});
            world.Add({.shape = CubeOf(0.5f), .position = {0, 1, 0}});
            const BodyId top = world.Add({.shape = CubeOf(0.5f), .position = {0, 2, 0}});
            world.Go(2);
            const double from = world.PositionOf(top).y();
            world.Go(10);
            EXPECT_NEAR((world.PositionOf(top).y() - from) / (10 * double(speed)), 1, 0.02) << pace << ", " << speed;
            EXPECT_TRUE(world.Bodies().IsAwake(top)) << pace << ", " << speed;
            ASSERT_TRUE(world.Bodies().SetVelocity(lift, {0, 0, 0}, {0, 0, 0}));
            world.Go(2);
            EXPECT_FALSE(world.Bodies().IsAwake(top)) << pace << ", " << speed;
        }
}

// ---- At rest

// A gate of 1000 kg that slides along `axis`; its motor does all it can.
class StalledMotor : public ::testing::Test {
protected:
    void ExpectSleep(const char* what, const AxisControl& slide, const Vector3& axis, bool isBlocked = false) {
        for (const Pace& pace : kPaces) {
            SlowWorld world(pace);
            const BodyId gate = world.Add({.shape = CubeOf(0.5f), .position = {0, 5, 0}});
            if (isBlocked) world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {1.3, 5, 0}});
            SliderJointSettings slider{Between(kWorldBody, gate, {0, 5, 0}, axis)};
            slider.slide = slide;
            Join(world, slider);
            world.Go(5);
            EXPECT_FALSE(world.Bodies().IsAwake(gate)) << what << ", " << pace;
        }
    }
};

TEST_F(StalledMotor, LetsItsBodySleep) {
    const Vector3 x(1, 0, 0), y(0, 1, 0);
    AxisControl atLimit = Limited(-1, 0.3), blocked, byFriction, holds, carries;
    atLimit.motor = blocked.motor = SpeedMotor(0.5, 1e5);
    byFriction.motor = SpeedMotor(0.5, 100);
    byFriction.friction = 200;
    holds.motor = SpeedMotor(0);
    carries.motor = PositionMotor(0, FrequencySpring(2, 1));  // 62 mm below its target
    ExpectSleep("at its limit", atLimit, x);
    ExpectSleep("against a wall", blocked, x, true);
    ExpectSleep("against friction", byFriction, x);
    ExpectSleep("a brake", holds, y);
    ExpectSleep("a spring", carries, y);
}

TEST(SlowDrift, BelowItsBoundEnds) {
    for (const Pace& pace : kPaces) {
        SlowWorld world(pace, 0);
        const BodyId drifts = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {0.008f, 0, 0}});
        const BodyId turns =
            world.Add({.shape = CubeOf(0.5f), .position = {5, 5, 0}, .angularVelocity = {0, 0, 0.008f}});
        world.Go(2);
        EXPECT_FALSE(world.Bodies().IsAwake(drifts)) << pace;
        EXPECT_FALSE(world.Bodies().IsAwake(turns)) << pace;
    }
}

}  // namespace
}  // namespace fulcrum::testing
