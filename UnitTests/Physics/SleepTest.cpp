// Islands fall asleep together, do not move at all, and wake when they are disturbed.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <vector>

namespace fulcrum::testing {
namespace {

std::vector<BodyId> AddStack(TestWorld& world, int count, double x = 0) {
    std::vector<BodyId> stack;
    for (int i = 0; i < count; ++i) stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = {x, 0.5 + i, 0}}));
    return stack;
}

bool AllAsleep(TestWorld& world, const std::vector<BodyId>& bodies) {
    for (BodyId id : bodies)
        if (world.Bodies().IsAwake(id)) return false;
    return true;
}
bool AllAwake(TestWorld& world, const std::vector<BodyId>& bodies) {
    for (BodyId id : bodies)
        if (!world.Bodies().IsAwake(id)) return false;
    return true;
}

TEST(Sleep, ABodyAtRestSleepsAfterItsTime) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(28);
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    world.Steps(10);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_EQ(world.Report().awakeBodies, 0u);
    EXPECT_EQ(world.VelocityOf(box), Vector3(0, 0, 0));
}

TEST(Sleep, SleepersLieStillToTheBit) {
    TestWorld world;
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 5);
    world.Run(5);
    ASSERT_TRUE(AllAsleep(world, stack));
    std::vector<BodyBits> before;
    for (BodyId id : stack) before.push_back(BitsOf(world, id));
    // Something moves elsewhere.
    world.Add({.shape = SphereOf(0.5f), .position = {20, 5, 0}});
    world.Run(5);
    for (size_t i = 0; i < stack.size(); ++i) EXPECT_EQ(BitsOf(world, stack[i]), before[i]) << i;
    EXPECT_TRUE(AllAsleep(world, stack));
}

TEST(Sleep, RemovingTheSupportWakesTheStack) {
    TestWorld world;
    world.AddFloor();
    const BodyId support =
        world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Static, .position = {0, 0.5, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().Remove(support));
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.005);
}

TEST(Sleep, RemovingADynamicSupportLetsTheRestFall) {
    TestWorld world;
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 4);
    world.Run(3);
    ASSERT_TRUE(AllAsleep(world, stack));
    ASSERT_TRUE(world.Bodies().Remove(stack[0]));
    world.Run(3);
    EXPECT_NEAR(world.PositionOf(stack[1]).y(), 0.5, 0.01);
    EXPECT_NEAR(world.PositionOf(stack[3]).y(), 2.5, 0.01);
}

TEST(Sleep, MovingTheSupportWakesWhatRestedOnIt) {
    TestWorld world;
    const BodyId support =
        world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Static, .position = {0, 0.5, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().SetPose(support, {10, 0.5, 0}, {}));
    world.Run(1);
    EXPECT_LT(world.PositionOf(box).y(), 0);
}

TEST(Sleep, AHitWakesTheWholeIsland) {
    TestWorld world;
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 4), other = AddStack(world, 4, 10);
    world.Run(3);
    ASSERT_TRUE(AllAsleep(world, stack));
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {-4, 3.5, 0}, .linearVelocity = {10, 0, 0}});
    for (int i = 0; i < 60 && !world.Bodies().IsAwake(stack[3]); ++i) world.Step();
    EXPECT_TRUE(AllAwake(world, stack));
    EXPECT_TRUE(AllAsleep(world, other));
    EXPECT_GT(world.PositionOf(ball).x(), -2);
}

TEST(Sleep, PushesWakeAndZeroGravityFactorsToo) {
    const auto wakes = [](auto act) {
        TestWorld world;
        world.AddFloor();
        const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
        world.Run(2);
        EXPECT_FALSE(world.Bodies().IsAwake(box));
        EXPECT_TRUE(act(world.Bodies(), box));
        return world.Bodies().IsAwake(box);
    };
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.AddForce(id, {1, 0, 0})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.AddTorque(id, {1, 0, 0})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.AddImpulse(id, {1, 0, 0})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.SetVelocity(id, {1, 0, 0}, {0, 0, 0})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.SetGravityFactor(id, -1)); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.SetMaterial(id, {})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.SetPose(id, {0, 5, 0}, {})); }));
    EXPECT_TRUE(wakes([](BodyInterface& b, BodyId id) { return bool(b.Wake(id)); }));
}

TEST(Sleep, IslandsSleepByThemselves) {
    TestWorld world;
    world.AddFloor({.friction = 0});
    const std::vector<BodyId> stack = AddStack(world, 3);
    const BodyId slides = world.Add(
        {.shape = CubeOf(0.5f), .position = {10, 0.5, 0}, .linearVelocity = {1, 0, 0}, .material = {.friction = 0}});
    world.Run(3);
    EXPECT_TRUE(AllAsleep(world, stack));
    EXPECT_TRUE(world.Bodies().IsAwake(slides));
}

TEST(Sleep, OneRestlessBodyKeepsItsIslandAwake) {
    TestWorld world;
    world.AddFloor();
    const BodyId restless = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .allowSleep = false});
    const BodyId onTop = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    const BodyId apart = world.Add({.shape = CubeOf(0.5f), .position = {5, 0.5, 0}});
    world.Run(3);
    EXPECT_TRUE(world.Bodies().IsAwake(restless));
    EXPECT_TRUE(world.Bodies().IsAwake(onTop));
    EXPECT_FALSE(world.Bodies().IsAwake(apart));
}

TEST(Sleep, ABodyAtTheTopOfItsFlightDoesNotSleep) {
    TestWorld world;
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .linearVelocity = {0, 2, 0}});
    world.Run(3);
    EXPECT_TRUE(world.Bodies().IsAwake(ball));
}

TEST(Sleep, StartsAsleepUntilHit) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 5, 0}, .startAsleep = true});
    world.Run(1);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_EQ(world.PositionOf(box).y(), 5);
    world.Add({.shape = SphereOf(0.5f), .position = {0, 8, 0}});
    world.Run(3);
    EXPECT_LT(world.PositionOf(box).y(), 1);
}

TEST(Sleep, IsPutToSleepByHandWithWhatItTouches) {
    TestWorld world;
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 3);
    world.Steps(5);
    ASSERT_TRUE(world.Bodies().Sleep(stack[1]));
    EXPECT_TRUE(AllAsleep(world, stack));
    ASSERT_TRUE(world.Bodies().Wake(stack[0]));
    EXPECT_TRUE(AllAwake(world, stack));
}

// Its pairs existed until the next step, so that falling asleep used a removed body and crashed.
TEST(Sleep, WhatWasRemovedTouchesNothingAtOnce) {
    for (int removed = 0; removed < 3; ++removed) {
        TestWorld world;
        world.AddFloor();
        std::vector<BodyId> stack = AddStack(world, 3);
        world.Steps(5);
        const BodyId gone = stack[static_cast<size_t>(removed)];
        ASSERT_TRUE(world.Bodies().Remove(gone));
        stack.erase(stack.begin() + removed);
        world.System().VisitContacts(
            [&](const ContactView& contact) { EXPECT_TRUE(contact.bodyA != gone && contact.bodyB != gone); });
        std::vector<uint32_t> islands;
        world.System().VisitIslands([&](BodyId, uint32_t island) { islands.push_back(island); });
        ASSERT_EQ(islands.size(), 2u);
        EXPECT_EQ(islands[0] == islands[1], removed != 1);
        ASSERT_TRUE(world.Bodies().Sleep(stack[0]));
        EXPECT_FALSE(world.Bodies().IsAwake(stack[0]));
        EXPECT_EQ(world.Bodies().IsAwake(stack[1]), removed == 1);
        world.Steps(5);
        EXPECT_TRUE(world.AllFinite());
    }
}

TEST(Sleep, AWokenStackStandsAsBefore) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 8);
    world.Run(20);  // until it no longer sways
    const Position top = world.PositionOf(stack.back());
    ASSERT_TRUE(world.Bodies().Sleep(stack[0]));
    world.Run(4);
    ASSERT_TRUE(AllAsleep(world, stack));
    ASSERT_TRUE(world.Bodies().Wake(stack[0]));
    // Impulses outlast the sleep, so nothing sags.
    for (int i = 0; i < 60; ++i) {
        world.Step();
        ASSERT_LT((world.PositionOf(stack.back()) - top).norm(), 1e-4) << i;
    }
}

TEST(Islands, AreNumberedByTheirFirstBody) {
    TestWorld world;
    world.AddFloor();
    const std::vector<BodyId> a = AddStack(world, 2), b = AddStack(world, 3, 5);
    for (int moment = 0; moment < 2; ++moment) {
        world.Run(moment == 0 ? 0.1 : 3);  // awake, then asleep
        std::vector<uint32_t> islands;
        world.System().VisitIslands([&](BodyId, uint32_t island) { islands.push_back(island); });
        EXPECT_EQ(islands, (std::vector<uint32_t>{0, 0, 1, 1, 1}));
    }
}

}  // namespace
}  // namespace fulcrum::testing
