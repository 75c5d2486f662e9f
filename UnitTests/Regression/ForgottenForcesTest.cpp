// A force of zero kept bodies awake, and a force on a body that was put to sleep acted when it woke.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

TEST(ForgottenForces, ForcesAndImpulsesOfZeroDoNothing) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    for (int i = 0; i < 120; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(box, Vector3::Zero()));
        ASSERT_TRUE(world.Bodies().AddForceAt(box, Vector3::Zero(), {1, 1, 1}));
        ASSERT_TRUE(world.Bodies().AddTorque(box, Vector3::Zero()));
        ASSERT_TRUE(world.Bodies().AddImpulse(box, Vector3::Zero()));
        ASSERT_TRUE(world.Bodies().AddImpulseAt(box, Vector3::Zero(), {1, 1, 1}));
        ASSERT_TRUE(world.Bodies().AddAngularImpulse(box, Vector3::Zero()));
        world.Step();
    }
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().AddForce(box, {1e-6f, 0, 0}));
    EXPECT_TRUE(world.Bodies().IsAwake(box));
}

TEST(ForgottenForces, SleepForgetsThem) {
    TestWorld world(NoGravity());
    const BodyId first = world.Add({.shape = CubeOf(0.5f)});
    const BodyId second = world.Add({.shape = CubeOf(0.5f), .position = {1, 0, 0}});  // of the same island
    world.Steps(2);
    for (const BodyId id : {first, second}) {
        ASSERT_TRUE(world.Bodies().AddForce(id, {0, 1e5f, 0}));
        ASSERT_TRUE(world.Bodies().AddTorque(id, {0, 1e5f, 0}));
    }
    ASSERT_TRUE(world.Bodies().Sleep(first));
    ASSERT_FALSE(world.Bodies().IsAwake(second));
    world.Steps(2);
    ASSERT_TRUE(world.Bodies().Wake(first));
    world.Step();
    for (const BodyId id : {first, second}) {
        EXPECT_LT(Length(world.VelocityOf(id)), 1e-3f);
        EXPECT_LT(Length(world.Bodies().GetAngularVelocity(id)), 1e-3f);
    }
}

}  // namespace
}  // namespace fulcrum::testing
