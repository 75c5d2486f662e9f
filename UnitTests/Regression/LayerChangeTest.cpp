// Changes of layerCollides had no effect on bodies that touched, or overlapped, already.
#include <Fulcrum/UnitTests/Physics/SensorTest.h>

namespace fulcrum::testing {
namespace {

SystemSettings Apart(bool areApart) {
    SystemSettings settings;
    if (areApart) {
        settings.layerCollides[1] &= ~(1u << 2);
        settings.layerCollides[2] &= ~(1u << 1);
    }
    return settings;
}

struct Stack {
    TestWorld world;
    BodyId floor, box, onTop;
    explicit Stack(bool areApart) : world(Apart(areApart)) {
        floor =
            world.Add({.shape = BoxOf(10, 1, 10), .motion = MotionType::Static, .position = {0, -1, 0}, .layer = 1});
        box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .layer = 2});
        onTop = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .layer = 2});
    }
    void Set(bool areApart) { ASSERT_TRUE(world.System().SetSettings(Apart(areApart))); }
};

TEST(LayerChange, EndsContactsThatNoLongerMayBe) {
    for (const bool sleeps : {false, true}) {
        Stack stack(false);
        stack.world.Steps(sleeps ? 200 : 10);
        ASSERT_EQ(stack.world.Bodies().IsAwake(stack.box), !sleeps);
        ASSERT_NEAR(stack.world.PositionOf(stack.box).y(), 0.5, 0.01);
        stack.Set(true);
        stack.world.Steps(60);
        // Both fall freely for a second.
        EXPECT_NEAR(stack.world.PositionOf(stack.box).y(), 0.5 - 0.5 * kGravity, 0.2);
        EXPECT_NEAR(stack.world.PositionOf(stack.onTop).y(), 1.5 - 0.5 * kGravity, 0.2);
    }
}

TEST(LayerChange, BeginsContactsThatNowMayBe) {
    Stack stack(true);
    ASSERT_TRUE(stack.world.Bodies().SetPose(stack.box, {0, 0.9, 0}, {}));
    ASSERT_TRUE(stack.world.Bodies().SetPose(stack.onTop, {0, 1.9, 0}, {}));
    stack.world.Steps(2);  // their bounds overlap those of the floor
    stack.Set(false);
    stack.world.Run(2);
    EXPECT_NEAR(stack.world.PositionOf(stack.box).y(), 0.5, 0.02);
    EXPECT_NEAR(stack.world.PositionOf(stack.onTop).y(), 1.5, 0.02);
}

TEST(LayerChange, WakesWhatOverlapsAsleep) {
    TestWorld world(Apart(true));
    const BodyId a = world.Add({.shape = SphereOf(0.5f), .gravityFactor = 0, .startAsleep = true, .layer = 1});
    const BodyId b = world.Add(
        {.shape = SphereOf(0.5f), .position = {0.4, 0, 0}, .gravityFactor = 0, .startAsleep = true, .layer = 2});
    world.Steps(5);
    ASSERT_TRUE(world.System().SetSettings(Apart(false)));
    world.Run(2);
    EXPECT_GT((world.PositionOf(a) - world.PositionOf(b)).norm(), 0.99);
}

TEST(LayerChange, LeavesOtherLayersAsleep) {
    Stack stack(false);
    const BodyId other = stack.world.Add({.shape = CubeOf(0.5f), .position = {5, 0.5, 0}});
    stack.world.Steps(200);
    ASSERT_FALSE(stack.world.Bodies().IsAwake(other));
    stack.Set(true);
    EXPECT_FALSE(stack.world.Bodies().IsAwake(other));
    EXPECT_TRUE(stack.world.Bodies().IsAwake(stack.box));
}

}  // namespace
}  // namespace fulcrum::testing
