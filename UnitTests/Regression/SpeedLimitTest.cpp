// The largest speeds of a body were applied before the solve alone: contacts, joints, bounces and hits of continuous
// collision left bodies faster, poses moved as fast, and each clamping substep counted as a body.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <random>
#include <vector>

namespace fulcrum::testing {
namespace {

// By how much a float may miss a length that it was brought to.
constexpr float kRounding = 1 + 1e-6f;

struct Limited {
    BodyId id;
    float linear, angular;
    Position before = Position::Zero();
};

// After each step: no speed above its limit, no way longer than it allows, and no more bodies counted than there are.
void StepAndCheck(TestWorld& world, std::vector<Limited>& bodies, double dt = kStep) {
    for (Limited& body : bodies) body.before = world.Bodies().GetCenterOfMass(body.id);
    world.Step(dt);
    for (const Limited& body : bodies) {
        EXPECT_LE(Length(world.VelocityOf(body.id)), body.linear * kRounding)
            << "step " << world.Report().step << ", body " << body.id.index;
        EXPECT_LE(Length(world.Bodies().GetAngularVelocity(body.id)), body.angular * kRounding)
            << "step " << world.Report().step << ", body " << body.id.index;
        const double way = (world.Bodies().GetCenterOfMass(body.id) - body.before).norm();
        // Positions lie on a grid of 2^-23 m.
        EXPECT_LE(way, double{body.linear} * dt * (1 + 1e-5) + 1e-6)
            << "step " << world.Report().step << ", body " << body.id.index;
    }
    EXPECT_LE(world.Report().clampedBodies, world.Report().bodies);
}

TEST(SpeedLimits, HoldForWhatContactsPush) {
    for (uint32_t seed : {1u, 2u, 3u}) {
        std::mt19937 random(seed);
        const auto within = [&](float low, float high) {
            return std::uniform_real_distribution<float>(low, high)(random);
        };
        TestWorld world(NoSleep());
        world.AddFloor({.restitution = 1});
        std::vector<Limited> bodies;
        for (int i = 0; i < 60; ++i) {
            const float linear = within(0.5f, 4), angular = within(0.5f, 4);
            const ShapePtr shape = i % 3 == 0 ? SphereOf(0.3f) : i % 3 == 1 ? CubeOf(0.25f) : CapsuleOf(0.3f, 0.2f);
            bodies.push_back({world.Add({.shape = shape,
                                         .position = {within(-1, 1), within(0.2f, 3), within(-1, 1)},
                                         .linearVelocity = {within(-9, 9), within(-9, 9), within(-9, 9)},
                                         .angularVelocity = {within(-9, 9), within(-9, 9), 0},
                                         .density = i % 5 == 0 ? 50000.0f : 500.0f,
                                         .material = {.restitution = 0.9f},
                                         .maxLinearSpeed = linear,
                                         .maxAngularSpeed = angular}),
                              linear, angular});
        }
        uint32_t clamped = 0;
        for (int i = 0; i < 200; ++i) {
            StepAndCheck(world, bodies, i % 2 ? 1.0 / 60 : 1.0 / 25);
            clamped = std::max(clamped, world.Report().clampedBodies);
            if (HasFailure()) return;
        }
        EXPECT_GT(clamped, 0u);
    }
}

TEST(SpeedLimits, HoldForWhatJointsPull) {
    TestWorld world(Weightless());
    std::vector<Limited> bodies;
    BodyId before = AddHook(world);
    for (int i = 0; i < 8; ++i) {
        // Apart by meters: pulled together at up to 20 m/s.
        const BodyId link =
            world.Add({.shape = CubeOf(0.1f), .position = {2.0 * i, 3, 0}, .maxLinearSpeed = 3, .maxAngularSpeed = 5});
        PointJointSettings joint;
        static_cast<JointSettings&>(joint) = Between(before, link, {0, 0, 0});
        joint.space = JointSpace::Body;
        joint.anchorB = JointAnchor{.point = {0.2, 0, 0}};
        Join(world, joint);
        bodies.push_back({link, 3, 5});
        before = link;
    }
    for (int i = 0; i < 200 && !HasFailure(); ++i) StepAndCheck(world, bodies);
    EXPECT_TRUE(world.AllFinite());
}

TEST(SpeedLimits, HoldForWhatABulletHits) {
    TestWorld world(NoGravity());
    std::vector<Limited> bodies;
    bodies.push_back({world.Add({.shape = SphereOf(0.05f),
                                 .position = {-20, 0, 0},
                                 .linearVelocity = {900, 0, 0},
                                 .density = 50000,
                                 .material = {.restitution = 1},
                                 .continuous = ContinuousCollision::Linear}),
                      1000, 300});
    for (int i = 0; i < 4; ++i)
        bodies.push_back({world.Add({.shape = SphereOf(0.1f),
                                     .position = {0.3 * i, 0.02, 0},
                                     .material = {.restitution = 1},
                                     .maxLinearSpeed = 20,
                                     .maxAngularSpeed = 5,
                                     .continuous = ContinuousCollision::Linear}),
                          20, 5});
    for (int i = 0; i < 20 && !HasFailure(); ++i) StepAndCheck(world, bodies);
}

TEST(SpeedLimits, HoldForBodiesThatTurnFreely) {
    // The angular velocity of a body with three moments grows and shrinks as it turns.
    TestWorld world(NoGravity());
    std::vector<Limited> bodies;
    for (float speed : {3.0f, 10.0f, 40.0f, 1000.0f})
        bodies.push_back({world.Add({.shape = BoxOf(0.1f, 0.3f, 0.7f),
                                     .position = {double(speed), 0, 0},
                                     .angularVelocity = {0.1f * speed, speed, speed},
                                     .maxAngularSpeed = speed}),
                          1000, speed});
    for (int i = 0; i < 200 && !HasFailure(); ++i) StepAndCheck(world, bodies);
}

TEST(SpeedLimits, HoldForKinematicBodies) {
    TestWorld world(NoGravity());
    std::vector<Limited> bodies;
    for (float speed : {1e3f, 1e10f, 1e25f, 3e38f})
        bodies.push_back({world.Add({.shape = CubeOf(0.5f),
                                     .motion = MotionType::Kinematic,
                                     .position = {0, 0, 10.0 * static_cast<double>(bodies.size())},
                                     .linearVelocity = {speed, 0, 0},
                                     .angularVelocity = {0, speed, 0},
                                     .maxLinearSpeed = 5,
                                     .maxAngularSpeed = 2}),
                          5, 2});
    const BodyId unlimited = world.Add({.shape = CubeOf(0.5f),
                                        .motion = MotionType::Kinematic,
                                        .position = {0, 50, 0},
                                        .angularVelocity = {0, 1e25f, 0},
                                        .maxLinearSpeed = 3e38f,
                                        .maxAngularSpeed = 3e38f});
    for (int i = 0; i < 30 && !HasFailure(); ++i) StepAndCheck(world, bodies);
    EXPECT_FALSE(world.Bodies().IsFrozen(unlimited));
    EXPECT_TRUE(world.AllFinite());
    EXPECT_NEAR(world.PositionOf(bodies.back().id).x(), 30 * kStep * 5, 1e-3);
}

TEST(SpeedLimits, HoldWhateverPushes) {
    for (double dt : {1.0 / 240, 1.0 / 60, 0.3}) {
        TestWorld world;
        world.AddFloor();
        std::vector<Limited> bodies;
        for (float mass : {1e-12f, 1.0f, 1e12f, 1e30f})
            bodies.push_back({world.Add({.shape = SphereOf(0.5f),
                                         .position = {4.0 * static_cast<double>(bodies.size()), 0.4, 0},
                                         .mass = mass,
                                         .maxLinearSpeed = 50,
                                         .maxAngularSpeed = 20}),
                              50, 20});
        for (int i = 0; i < 60 && !HasFailure(); ++i) {
            for (const Limited& body : bodies) {
                ASSERT_TRUE(world.Bodies().AddForce(body.id, {1e30f, i % 2 ? 1e30f : -1e30f, 0}));
                ASSERT_TRUE(world.Bodies().AddTorque(body.id, {1e30f, 0, 1e30f}));
                ASSERT_TRUE(world.Bodies().AddImpulse(body.id, {-1e30f, 0, 3e38f}));
                ASSERT_TRUE(world.Bodies().AddAngularImpulse(body.id, {0, 3e38f, 0}));
            }
            StepAndCheck(world, bodies, dt);
            EXPECT_EQ(world.Report().frozenBodies, 0u);
        }
        EXPECT_TRUE(world.AllFinite()) << dt;
    }
}

TEST(SpeedLimits, EachBodyIsCountedOnceAStep) {
    SystemSettings settings = NoSleep();
    settings.solver.substeps = 8;
    TestWorld world(settings);
    world.AddFloor();
    std::vector<Limited> bodies;
    for (int i = 0; i < 50; ++i)
        bodies.push_back(
            {world.Add(
                 {.shape = SphereOf(0.5f), .position = {2.0 * (i % 10), 0.5, 2.0 * (i / 10)}, .maxLinearSpeed = 1}),
             1, 300});
    for (int i = 0; i < 20 && !HasFailure(); ++i) {
        for (const Limited& body : bodies) ASSERT_TRUE(world.Bodies().AddForce(body.id, {1e6f, 0, 0}));
        StepAndCheck(world, bodies);
        EXPECT_EQ(world.Report().clampedBodies, 50u);
    }
    // What coasts at its limit is not clamped.
    for (int i = 0; i < 20; ++i) {
        StepAndCheck(world, bodies);
        EXPECT_EQ(world.Report().clampedBodies, 0u) << i;
    }
}

TEST(SpeedLimits, BallsInTheFloorThatSpinBeyondAllNumbersSpoilNothing) {
    for (float spin : {1e4f, 1e10f, 1e20f, 1e30f, 3e38f}) {
        TestWorld world(NoSleep());
        const BodyId floor = world.AddFloor();
        std::vector<BodyId> bodies = {floor, world.Add({.shape = SphereOf(0.5f),
                                                        .position = {0, 0.1, 0},
                                                        .angularVelocity = {spin, spin, -spin},
                                                        .maxLinearSpeed = 3e38f,
                                                        .maxAngularSpeed = 3e38f})};
        for (int i = 0; i < 6; ++i)
            bodies.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0.9 * (i % 3 - 1), 0.5 + i / 3, 0.9}}));
        for (int i = 0; i < 60; ++i) {
            world.Step();
            ASSERT_TRUE(world.AllFinite()) << spin << ", step " << i;
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
