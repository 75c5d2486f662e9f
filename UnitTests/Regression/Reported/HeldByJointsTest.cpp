// Reported of joints elsewhere: drives that let a body slip, springs that blow up on a turning body, fixed joints that
// give way as they are spun, continuous collision that ignores which bodies a joint lets pass.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

// A vertical drive of speed 0 with unlimited force, the body's center 3 m beside it. In 5 s it would slip by
// what a hundredth of a millimeter a step makes: 3 mm.
TEST(HeldByJoints, ADriveOfNoSpeedHolds) {
    const auto slipped = [](auto settings, float mass) {
        TestWorld world(NoSleep());
        settings.bodyA = kWorldBody;
        settings.bodyB = world.Add({.shape = CubeOf(0.5f), .position = {3, 5, 0}, .mass = mass});
        settings.anchorA.point = {0, 5, 0};
        EXPECT_TRUE(world.System().Joints().Create(settings));
        world.Run(5);
        return 5 - world.PositionOf(settings.bodyB).y();
    };
    SixDofJointSettings any;
    for (size_t k = 0; k < 6; ++k) any.axes[k].limited = k != 1;
    any.axes[1].motor = {.mode = MotorMode::ToVelocity};
    SliderJointSettings slider;
    slider.anchorA.axis = {0, 1, 0};
    slider.slide.motor = {.mode = MotorMode::ToVelocity};
    EXPECT_NEAR(slipped(any, 1), 0, 5e-4);
    EXPECT_NEAR(slipped(slider, 1), 0, 5e-4);
    EXPECT_NEAR(slipped(slider, 10'000), 0, 5e-4);
}

// A body on a spring of w rad/s that is carried around at the rate n stretches it from r to r / (1 - n2 / w2) at rest;
// it swings in up to as far again as it starts, from no speed, and falls by g / w2. Faster than the spring it has no
// rest: then it must stay bounded, and spins no faster than the body that carries it, several times.
TEST(HeldByJoints, ASpringOnATurningBodyStaysBounded) {
    for (const double rate : {2.0, 20.0})
        for (const float frequency : {3.0f, 60.0f}) {
            TestWorld world;
            SixDofJointSettings joint;
            joint.bodyA = world.Add({.shape = CubeOf(0.5f),
                                     .motion = MotionType::Kinematic,
                                     .position = {0, 5, 0},
                                     .angularVelocity = {0, static_cast<float>(rate), 0}});
            joint.bodyB = world.Add({.shape = CubeOf(0.3f), .position = {2, 5, 0}});
            joint.anchorA.point = {2, 5, 0};
            for (AxisControl& axis : joint.axes) {
                axis.limited = true;
                axis.limits.spring = {.frequency = frequency, .dampingRatio = 0.1f};
            }
            ASSERT_TRUE(world.System().Joints().Create(joint));
            double farthest = 0, spin = 0;
            for (int step = 0; step < 300; ++step) {
                world.Step();
                farthest = std::max(farthest, (world.PositionOf(joint.bodyB) - Position(0, 5, 0)).norm());
                spin = std::max(spin, double{Length(world.Bodies().GetAngularVelocity(joint.bodyB))});
            }
            const double w = 2 * kPi * frequency;
            const std::string name = std::to_string(rate) + " rad/s, " + std::to_string(frequency) + " Hz";
            if (rate < w) {
                const double rest = 2 / (1 - rate * rate / (w * w));
                EXPECT_GT(farthest, 0.95 * rest) << name;
                EXPECT_LT(farthest, 2 * rest + kGravity / (w * w)) << name;
            } else {
                EXPECT_LT(spin, 10 * rate) << name;
            }
        }
}

// A small body that is spun at 20 rad/s, fixed to a beam of 100 m: together they keep the angular momentum, which is
// that of the small one alone, and have less energy, since it is an inelastic impact.
TEST(HeldByJoints, AFixedJointHoldsABeamThatIsSpun) {
    for (const double beamAt : {20.0, 52.0}) {
        TestWorld world(NoGravity());
        FixedJointSettings fixed;
        const BodyId hub = fixed.bodyA = world.Add({.shape = CubeOf(2),
                                                    .angularVelocity = {0, 20, 0},
                                                    .lockedAxes = LockedAxes::RotationX | LockedAxes::RotationZ});
        const BodyId beam = fixed.bodyB = world.Add({.shape = BoxOf(50, 2, 2), .position = {beamAt, 4.5, 0}});
        fixed.anchorA.point = {0, 2.25, 0};
        ASSERT_TRUE(world.System().Joints().Create(fixed));
        BodyInterface& bodies = world.Bodies();
        const double massOfHub = bodies.GetMass(hub), massOfBeam = bodies.GetMass(beam);
        const auto momentum = [&] {
            const Position a = bodies.GetCenterOfMass(hub), b = bodies.GetCenterOfMass(beam),
                           center = (a * massOfHub + b * massOfBeam) / (massOfHub + massOfBeam);
            const auto of = [&](BodyId id, const Position& at, double mass) {
                const Position r = at - center, v = bodies.GetLinearVelocity(id).cast<double>();
                return mass * (r.z() * v.x() - r.x() * v.z()) + bodies.GetAngularMomentum(id).y();
            };
            return of(hub, a, massOfHub) + of(beam, b, massOfBeam);
        };
        const double first = momentum(), energy = bodies.GetKineticEnergy(hub);
        for (int step = 0; step < 180; ++step) {
            world.Step();
            const Quaternion turn = bodies.GetPose(hub).rotation.Conjugate() * bodies.GetPose(beam).rotation;
            ASSERT_GT(std::fabs(turn.w), std::cos(0.5 * 0.03)) << "parted by more than 0.03 rad in step " << step;
            ASSERT_LT(bodies.GetKineticEnergy(hub) + bodies.GetKineticEnergy(beam), 1.001 * energy);
        }
        EXPECT_NEAR(momentum() / first, 1, 0.03);
    }
}

// The slider lets the capsule pass the other one: 20 m in 0.2 s.
TEST(HeldByJoints, ContinuousCollisionPassesWhatAJointLetsPass) {
    for (const ContinuousCollision continuous : {ContinuousCollision::Linear, ContinuousCollision::LinearAndAngular}) {
        TestWorld world(NoGravity());
        SliderJointSettings slider;
        slider.bodyA = world.Add({.shape = CapsuleOf(0.5f, 0.3f), .motion = MotionType::Static});
        slider.bodyB = world.Add({.shape = CapsuleOf(0.5f, 0.3f),
                                  .position = {0, -3, 0},
                                  .linearVelocity = {0, 100, 0},
                                  .continuous = continuous});
        slider.anchorA.point = {0, -3, 0};
        slider.anchorA.axis = {0, 1, 0};
        ASSERT_TRUE(world.System().Joints().Create(slider));
        world.Steps(12);
        EXPECT_NEAR(world.PositionOf(slider.bodyB).y() + 3, 20, 0.01);
    }
}

}  // namespace
}  // namespace fulcrum::testing
