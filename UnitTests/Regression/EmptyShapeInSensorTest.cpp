// A body that rested in a sensor stayed inside forever when one of the two got the empty shape.
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/UnitTests/Physics/SensorTest.h>

namespace fulcrum::testing {
namespace {

struct Pair {
    TestWorld world{NoGravity()};
    BodyId sensor, body;
    explicit Pair(bool sleeps) {
        sensor = world.Add(SensorOf(CubeOf(1)));
        body = world.Add({.shape = SphereOf(0.5f), .allowSleep = sleeps});
        world.Steps(60);
        EXPECT_EQ(world.Bodies().IsAwake(body), !sleeps);
        EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{body});
    }
};

TEST(EmptyShapeInSensor, TheBodyLeaves) {
    for (const bool sleeps : {false, true}) {
        Pair pair(sleeps);
        ASSERT_TRUE(pair.world.Bodies().SetShape(pair.body, EmptyShape::Create(), MassUpdate::Keep));
        pair.world.Step();
        ExpectKinds(pair.world, {kEnd});
        EXPECT_TRUE(InsideOf(pair.world, pair.sensor).empty());
        pair.world.Step();
        ExpectKinds(pair.world, {});
        ASSERT_TRUE(pair.world.Bodies().SetShape(pair.body, SphereOf(0.5f), MassUpdate::Keep));
        pair.world.Step();
        EXPECT_EQ(InsideOf(pair.world, pair.sensor), std::vector<BodyId>{pair.body});
    }
}

TEST(EmptyShapeInSensor, NothingIsInsideOfIt) {
    for (const bool sleeps : {false, true}) {
        Pair pair(sleeps);
        ASSERT_TRUE(pair.world.Bodies().SetShape(pair.sensor, EmptyShape::Create()));
        pair.world.Step();
        ExpectKinds(pair.world, {kEnd});
        EXPECT_TRUE(InsideOf(pair.world, pair.sensor).empty());
    }
}

}  // namespace
}  // namespace fulcrum::testing
