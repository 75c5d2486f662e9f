// A box that spins about its middle axis of inertia, free of all forces: its motion is that of Euler's equations.
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <vector>

namespace fulcrum::testing {
namespace {

// Full sizes 0.1 x 0.4 x 0.9 m, 10 kg: I = (0.80833, 0.68333, 0.14167) kg m2.
BodySettings SpinningBox() {
    return {.shape = BoxOf(0.05f, 0.2f, 0.45f), .angularVelocity = {0.1f, 5, 0.1f}, .mass = 10};
}

constexpr double kMomentum = 3.41765;  // N m s
constexpr double kEnergy = 8.5464;     // J

TEST(FreeRotation, KeepsTheAngularMomentum) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add(SpinningBox());
    const Vector3 start = world.Bodies().GetAngularMomentum(box);
    ASSERT_NEAR(Length(start), kMomentum, 1e-4);
    // Each step hands L over as an angular velocity, with some ten roundings there and back.
    const double tolerance = 600 * 10 * std::exp2(-24);
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        worst = std::max(worst, double(Length(Vector3(world.Bodies().GetAngularMomentum(box) - start))) / kMomentum);
    }
    EXPECT_LT(worst, tolerance);
}

TEST(FreeRotation, HardlyChangesTheEnergy) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add(SpinningBox());
    double worst = 0;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        worst = std::max(worst, std::fabs(world.Bodies().GetKineticEnergy(box) / kEnergy - 1));
    }
    // Roundings of the velocity, 6e-8 of the energy each, at random: 1.5e-6 after 600 steps. Three times that, and as
    // much again for what reading the energy back rounds.
    EXPECT_LT(worst, 1e-5);
}

// A lock exerts torque about its own axis alone: it does no work and leaves the other components of L.
TEST(FreeRotation, AboutTwoAxesKeepsEnergyAndMomentum) {
    for (const LockedAxes lock : {LockedAxes::RotationX, LockedAxes::RotationY, LockedAxes::RotationZ}) {
        TestWorld world(NoGravity());
        const auto withoutLocked = [&](Vector3 v) {
            for (unsigned k = 0; k < 3; ++k)
                if (static_cast<unsigned>(lock) >> (3 + k) & 1) v[k] = 0;
            return v;
        };
        BodySettings settings = SpinningBox();
        settings.rotation = Normalized(Quaternion{0.3f, 0.2f, -0.5f, 0.7f});
        settings.angularVelocity = withoutLocked({3, 4, 5});
        settings.lockedAxes = lock;
        const BodyId box = world.Add(settings);
        const auto momentumOf = [&] { return withoutLocked(world.Bodies().GetAngularMomentum(box)); };
        const double energy = world.Bodies().GetKineticEnergy(box);
        const Vector3 momentum = momentumOf();
        double worst = 0, worstMomentum = 0;
        for (int i = 0; i < 600; ++i) {
            world.Step();
            worst = std::max(worst, std::fabs(world.Bodies().GetKineticEnergy(box) / energy - 1));
            worstMomentum =
                std::max(worstMomentum, double(Length(Vector3(momentumOf() - momentum)) / Length(momentum)));
        }
        EXPECT_LT(worst, 1e-4) << static_cast<int>(lock);
        EXPECT_LT(worstMomentum, 0.01) << static_cast<int>(lock);
    }
}

TEST(FreeRotation, HardlyChangesTheEnergyOfWhatSpinsAsFastAsADrill) {
    // At 1000 rad/s a step of 1/60 s is 16.7 rad: 132 substeps of a tenth, where at most 64 were made, and the energy
    // rose by 1.7 %.
    for (float speed : {300.0f, 1000.0f}) {
        TestWorld world(NoGravity());
        const BodyId box = world.Add({.shape = BoxOf(0.05f, 0.2f, 0.45f),
                                      .angularVelocity = {0.02f * speed, speed, 0.02f * speed},
                                      .mass = 10,
                                      .maxAngularSpeed = 1e4f});
        const double before = world.Bodies().GetKineticEnergy(box);
        double worst = 0;
        for (int i = 0; i < 600; ++i) {
            world.Step();
            worst = std::max(worst, std::fabs(world.Bodies().GetKineticEnergy(box) / before - 1));
        }
        EXPECT_LT(worst, 2e-3) << speed << " rad/s";
    }
}

TEST(FreeRotation, FlipsWhenEulersEquationsSay) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add(SpinningBox());
    std::vector<double> flips;
    double before = 5;
    const double dt = 1.0 / 60;
    for (int i = 1; i <= 600; ++i) {
        world.Step(dt);
        const Quaternion q = world.Bodies().GetPose(box).rotation;
        const double now = double(InverseRotate(q, world.Bodies().GetAngularVelocity(box)).y());
        if ((now < 0) != (before < 0)) flips.push_back(dt * (i - 1 + before / (before - now)));
        before = now;
    }
    ASSERT_GE(flips.size(), 3u);
    const double expected[3] = {1.166, 4.194, 7.223};
    // The box starts so near to its middle axis that its energy is only a 2e-5th of itself below that of the
    // separatrix. When it flips follows from the logarithm of that difference: an error e of the energy shifts a flip
    // by e / 2e-5 / (2 lambda), lambda = 1.9 / s. Velocities are handed from step to step as floats: 6e-8 of the energy
    // each, at random, which comes to 6e-8 sqrt(60 t) by the time t, or 6 ms sqrt(t / s). (The method's own error is
    // 0.3 ms.) Three times that:
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(flips[i], expected[i], 18e-3 * std::sqrt(expected[i])) << i;
}

TEST(FreeRotation, ASphereKeepsItsAngularVelocity) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .angularVelocity = {1, 2, 3}});
    world.Run(10);
    EXPECT_EQ(world.Bodies().GetAngularVelocity(ball), Vector3(1, 2, 3));
}

TEST(FreeRotation, TurnsByTheAngularVelocityTimesTime) {
    TestWorld world(NoGravity());
    // One turn in one second.
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .angularVelocity = {0, static_cast<float>(2 * kPi), 0}});
    world.Run(0.25);
    const Vector3 x = Rotate(world.Bodies().GetPose(ball).rotation, Vector3(1, 0, 0));
    // 15 products of quaternions, each rounded.
    EXPECT_NEAR(x.x(), 0, 1e-5);
    EXPECT_NEAR(x.z(), -1, 1e-5);
}

TEST(FreeRotation, WithoutGyroscopicTorqueTheAngularVelocityStays) {
    TestWorld world(NoGravity());
    BodySettings settings = SpinningBox();
    settings.gyroscopicTorque = false;
    const BodyId box = world.Add(settings);
    world.Run(2);
    EXPECT_EQ(world.Bodies().GetAngularVelocity(box), settings.angularVelocity);
}

TEST(FreeRotation, AFastSpinGainsNoEnergy) {
    for (float speed : {20.0f, 100.0f, 290.0f}) {
        TestWorld world(NoGravity());
        const BodyId box = world.Add(
            {.shape = BoxOf(0.05f, 0.2f, 0.45f), .angularVelocity = Vector3(0.02f, 1, 0.02f) * speed, .mass = 10});
        const double start = world.Bodies().GetKineticEnergy(box);
        double most = 0;
        for (int i = 0; i < 600; ++i) {
            world.Step();
            most = std::max(most, world.Bodies().GetKineticEnergy(box) / start);
        }
        EXPECT_LE(most, 1.01) << speed << " rad/s";
    }
}

// Which bodies are rotated together depends on the number of threads: it must not matter.
TEST(FreeRotation, IsTheSameAloneAndTogether) {
    RandomPoses random(7);
    for (int round = 0; round < 500; ++round) {
        BodyDynamics bodies[kTurnsTogether];
        FreeTurn together[kTurnsTogether], alone[kTurnsTogether];
        for (int i = 0; i < kTurnsTogether; ++i) {
            const float across = random.Between(0.1f, 2), along = random.Between(0.1f, 2);
            Vector3 inertia = Vector3::Constant(across);
            inertia[(round + i) % 3] = along;
            SetMass(bodies[i], random.Rotation(), 1, inertia);
            ASSERT_TRUE(IsSymmetric(bodies[i]));
            const Quaternion rotation = random.Rotation();
            const Vector3 w = random.InCube() * 30.0f, torque = random.InCube();
            together[i] = alone[i] = {&bodies[i], rotation, w, torque};
        }
        const int count = 1 + round % kTurnsTogether;
        FreeTurn* const turns[kTurnsTogether] = {&together[0], &together[1], &together[2], &together[3]};
        RotateTogether(turns, count, 1.0f / 60);
        for (int i = 0; i < count; ++i) {
            RotateFreely(alone[i], 1.0f / 60);
            EXPECT_EQ(together[i].angularVelocity, alone[i].angularVelocity);
            EXPECT_EQ(together[i].rotation.x, alone[i].rotation.x);
            EXPECT_EQ(together[i].rotation.w, alone[i].rotation.w);
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
