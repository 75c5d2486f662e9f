// Bodies that are checked beforehand and created together.
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <future>

namespace fulcrum::testing {
namespace {

std::vector<BodySettings> ManyBodies() {
    std::vector<BodySettings> bodies;
    RandomPoses random(4);
    const ShapePtr shapes[] = {
        SphereOf(0.3f), CubeOf(0.3f), CapsuleOf(0.3f, 0.2f),
        CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}})};
    for (int i = 0; i < 200; ++i) {
        const Vector3 at = random.InBox(5);
        bodies.push_back({.shape = shapes[i % 4],
                          .motion = i % 7 == 0 ? MotionType::Static : MotionType::Dynamic,
                          .position = (at + Vector3(0, 6, 0)).cast<double>(),
                          .rotation = random.Rotation(),
                          .startAsleep = i % 7 != 0 && i % 11 == 0,
                          .isSensor = i % 13 == 0});
    }
    return bodies;
}

TEST(BodyBatch, AreTheSameBodiesAsOneByOne) {
    TestWorld together, alone;
    for (TestWorld* world : {&together, &alone}) world->AddFloor();
    const Result<BodyBatch> batch = BodyBatch::Prepare(ManyBodies());
    ASSERT_TRUE(batch);
    const Result<std::vector<BodyId>> ids = together.Bodies().Commit(batch.Value());
    ASSERT_TRUE(ids);
    std::vector<BodyId> expected;
    for (const BodySettings& settings : ManyBodies()) expected.push_back(alone.Add(settings));
    EXPECT_EQ(ids.Value(), expected);
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(together.System().HashState(), alone.System().HashState()) << step;
        together.Step();
        alone.Step();
    }
}

TEST(BodyBatch, IsRefusedAsAWholeAndNamesTheBody) {
    std::vector<BodySettings> bodies = ManyBodies();
    bodies[57].density = -1;
    const Result<BodyBatch> batch = BodyBatch::Prepare(bodies);
    ASSERT_FALSE(batch);
    EXPECT_NE(batch.GetError().message.find("bodies[57]: "), std::string::npos) << batch.GetError().message;
    bodies[3].shape = nullptr;
    EXPECT_NE(BodyBatch::Prepare(bodies).GetError().message.find("bodies[3]: "), std::string::npos);
    TestWorld world;
    EXPECT_TRUE(world.Bodies().Commit(BodyBatch::Prepare({}).Value()).Value().empty());
}

TEST(BodyBatch, IsPreparedWhileTheWorldSteps) {
    TestWorld world({}, 2);
    world.AddFloor();
    for (int round = 0; round < 5; ++round) {
        std::future<Result<BodyBatch>> next =
            std::async(std::launch::async, [] { return BodyBatch::Prepare(ManyBodies()); });
        for (int step = 0; step < 5; ++step) world.Step();
        const Result<BodyBatch> batch = next.get();
        ASSERT_TRUE(batch);
        const Result<std::vector<BodyId>> ids = world.Bodies().Commit(batch.Value());
        ASSERT_TRUE(ids);
        world.Steps(3);
        for (const BodyId id : ids.Value()) ASSERT_TRUE(world.Bodies().Remove(id));
    }
    EXPECT_TRUE(world.AllFinite());
}

// Memory grows as vectors do, however many batches it takes.
TEST(BodyBatch, ManySmallOnesDoNotCopyEverythingEachTime) {
    TestWorld world;
    const BodyBatch batch = BodyBatch::Prepare({{.shape = CubeOf(0.1f), .motion = MotionType::Static}}).Value();
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 4000; ++i) ASSERT_TRUE(world.Bodies().Commit(batch));
    // The ids of each, and the growth of some twenty buffers.
    EXPECT_LT(AllocationCount() - before, 4000u + 800);
}

}  // namespace
}  // namespace fulcrum::testing
