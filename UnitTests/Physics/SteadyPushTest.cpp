// Forces that are given in each step: they let a body sleep while they stay the same, and wake it when they do not.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

// A box of 1000 kg on the floor that is pushed by 2 kN along x, less than friction holds: 4.9 kN.
class PushedBox : public ::testing::Test {
protected:
    PushedBox() { world.AddFloor(); }
    void Push(int steps, const Vector3& force, const Vector3& torque = Vector3::Zero()) {
        for (int i = 0; i < steps; ++i) {
            ASSERT_TRUE(world.Bodies().AddForce(box, force));
            ASSERT_TRUE(world.Bodies().AddTorque(box, torque));
            world.Step();
        }
    }
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const Vector3 steady = Vector3(2000, 0, 0);
};

TEST_F(PushedBox, SleepsUnderASteadyForceAndTorque) {
    Push(90, steady, {0, 100, 0});
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    const BodyBits before = BitsOf(world, box);
    Push(60, steady, {0, 100, 0});
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_EQ(BitsOf(world, box), before);
    EXPECT_EQ(world.Report().awakeBodies, 0u);
}

TEST_F(PushedBox, WakesWhenTheForceGrowsAndSlidesWithIt) {
    Push(90, steady);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    const double x = world.PositionOf(box).x();
    Push(1, {7000, 0, 0});
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    // (7000 - 0.5 m g) / m from the first step on.
    Push(29, {7000, 0, 0});
    const double time = 30 * kStep, acceleration = 7 - 0.5 * kGravity;
    EXPECT_NEAR(world.PositionOf(box).x() - x, 0.5 * acceleration * time * time, 0.02);
}

TEST_F(PushedBox, WakesWhenTheForceEndsOrTurns) {
    Push(90, steady);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    world.Step();
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    world.Run(1);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    Push(90, steady);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    Push(1, {0, 0, 2000});
    EXPECT_TRUE(world.Bodies().IsAwake(box));
}

TEST_F(PushedBox, WakesByTheFirstForceOfAll) {
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().AddForce(box, {1, 0, 0}));
    EXPECT_TRUE(world.Bodies().IsAwake(box));
}

TEST_F(PushedBox, AForceThatChangesKeepsItAwake) {
    for (int i = 0; i < 120; ++i) Push(1, {i % 2 == 0 ? 1000.0f : 1200.0f, 0, 0});
    EXPECT_TRUE(world.Bodies().IsAwake(box));
}

// What changes too slowly for any one step to tell wakes it once it has changed by a hundredth in all.
TEST_F(PushedBox, ASlowChangeWakesItInTheEnd) {
    Push(90, steady);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    int steps = 0;
    for (; steps < 50 && !world.Bodies().IsAwake(box); ++steps) Push(1, steady * (1 + 0.002f * float(steps)));
    EXPECT_EQ(steps, 7);  // the first beyond 1 % is that of 1.012
}

// Put to sleep by a call it has no push to sleep under: the next one wakes it, none does not.
TEST_F(PushedBox, PutToSleepItSleepsWithoutAPush) {
    Push(20, steady);
    ASSERT_TRUE(world.Bodies().AddForce(box, steady));
    ASSERT_TRUE(world.Bodies().Sleep(box));
    world.Steps(5);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().AddForce(box, steady));
    EXPECT_TRUE(world.Bodies().IsAwake(box));
}

// Hit in its sleep, it has its force in the same step as before.
TEST(SteadyPush, ABodyThatIsHitInItsSleepIsHeldUpInTheSameStep) {
    TestWorld world;
    const BodyId balloon = world.Add({.shape = CubeOf(0.5f), .position = {0, 5, 0}, .mass = 10});
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {-8, 5, 0}, .gravityFactor = 0});
    ASSERT_TRUE(world.Bodies().Sleep(ball));
    const auto lift = [&] { ASSERT_TRUE(world.Bodies().AddForce(balloon, {0, static_cast<float>(10 * kGravity), 0})); };
    for (int i = 0; i < 90; ++i) lift(), world.Step();
    ASSERT_FALSE(world.Bodies().IsAwake(balloon));
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, {10, 0, 0}, {0, 0, 0}));
    for (int i = 0; i < 120; ++i) lift(), world.Step();
    EXPECT_GT(world.VelocityOf(balloon).x(), 0.1f);
    // A step without its force would give 0.16 m/s down.
    EXPECT_NEAR(world.VelocityOf(balloon).y(), 0, 0.01);
}

TEST(SteadyPush, GoesWithSnapshots) {
    TestWorld a, b;
    const auto fill = [](TestWorld& world) {
        world.AddFloor();
        return world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    };
    const BodyId box = fill(a);
    fill(b);
    const auto push = [&](TestWorld& world, int steps) {
        for (int i = 0; i < steps; ++i) {
            ASSERT_TRUE(world.Bodies().AddForce(box, {2000, 0, 0}));
            world.Step();
        }
    };
    push(a, 90);
    ASSERT_FALSE(a.Bodies().IsAwake(box));
    std::vector<std::byte> bytes;
    ASSERT_TRUE(a.System().SaveSnapshot(bytes));
    ASSERT_TRUE(b.System().RestoreSnapshot(bytes));
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    push(a, 30);
    push(b, 30);
    EXPECT_FALSE(b.Bodies().IsAwake(box));
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    a.Steps(5);
    b.Steps(5);
    EXPECT_TRUE(b.Bodies().IsAwake(box));
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
}

// ---- Kinematic bodies that are moved for a step

TEST(MoveKinematic, MovesForOneStepAndRests) {
    TestWorld world;
    const BodyId lift = world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Kinematic});
    ASSERT_TRUE(world.Bodies().MoveKinematic(lift, {0.5, 0, 0}, {}, static_cast<float>(kStep)));
    world.Step();
    // Until the next step it has the velocity that it moved with.
    EXPECT_NEAR(world.VelocityOf(lift).x(), 30, 1e-4);
    const Position there = world.PositionOf(lift);
    EXPECT_NEAR(there.x(), 0.5, 1e-6);
    world.Step();
    EXPECT_EQ(world.PositionOf(lift), there);
    EXPECT_EQ(world.VelocityOf(lift), Vector3(0, 0, 0));
    EXPECT_FALSE(world.Bodies().IsAwake(lift));
    // Told again it moves again; SetVelocity lasts.
    ASSERT_TRUE(world.Bodies().MoveKinematic(lift, {1, 0, 0}, {}, static_cast<float>(kStep)));
    world.Step();
    ASSERT_TRUE(world.Bodies().SetVelocity(lift, {1, 0, 0}, {0, 0, 0}));
    world.Steps(60);
    EXPECT_NEAR(world.PositionOf(lift).x(), 2, 1e-5);
}

TEST(MoveKinematic, AStepOfNoTimeIsNone) {
    TestWorld world;
    const BodyId lift = world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Kinematic});
    ASSERT_TRUE(world.Bodies().MoveKinematic(lift, {0.5, 0, 0}, {}, static_cast<float>(kStep)));
    world.Step(0);
    world.Step();
    EXPECT_NEAR(world.PositionOf(lift).x(), 0.5, 1e-6);
}

TEST(MoveKinematic, GoesWithSnapshots) {
    TestWorld a, b;
    const BodyId lift = a.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Kinematic});
    b.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Kinematic});
    ASSERT_TRUE(a.Bodies().MoveKinematic(lift, {0.5, 0, 0}, {}, static_cast<float>(kStep)));
    std::vector<std::byte> before, after;
    ASSERT_TRUE(a.System().SaveSnapshot(before));
    a.Step();
    ASSERT_TRUE(a.System().SaveSnapshot(after));
    ASSERT_TRUE(b.System().RestoreSnapshot(before));
    b.Steps(2);
    a.Step();
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    ASSERT_TRUE(b.System().RestoreSnapshot(after));
    b.Step();
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    EXPECT_NEAR(b.PositionOf(lift).x(), 0.5, 1e-6);
}

}  // namespace
}  // namespace fulcrum::testing
