// Changes queued by other threads and by callbacks of a step.
#include <Fulcrum/Samples/Embedding/EditQueue.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <thread>

namespace fulcrum::testing {
namespace {

TEST(EditQueue, MakesThemInOrder) {
    TestWorld world;
    samples::EditQueue queue;
    std::vector<int> made;
    queue.Add([&](PhysicsSystem&) { made.push_back(3); }, 2);
    queue.Add([&](PhysicsSystem&) { made.push_back(1); }, 1);
    queue.Add(
        [&](PhysicsSystem&) {
            made.push_back(2);
            queue.Add([&](PhysicsSystem&) { made.push_back(4); });  // the next time
        },
        1);
    queue.Apply(world.System());
    EXPECT_EQ(made, (std::vector<int>{1, 2, 3}));
    queue.Apply(world.System());
    EXPECT_EQ(made, (std::vector<int>{1, 2, 3, 4}));
    queue.Apply(world.System());
    EXPECT_EQ(made.size(), 4u);
}

// Eggs that burst where they hit the floor: callbacks must not remove them, but may say so. The same bits with any
// number of threads.
struct Bursting : ContactListener {
    samples::EditQueue& queue;
    BodyId floor;
    Bursting(samples::EditQueue& q, BodyId f) : queue(q), floor(f) {}
    void ModifyContact(const ContactView& contact, ContactChange&) const override {
        const BodyId egg = contact.bodyA == floor ? contact.bodyB : contact.bodyA;
        const bool isOnFloor = contact.bodyA == floor || contact.bodyB == floor;
        if (!isOnFloor || contact.points.front().separation > 0) return;
        queue.Add([egg](PhysicsSystem& system) { static_cast<void>(system.Bodies().Remove(egg)); }, egg.index);
    }
};

TEST(EditQueue, IsFilledByCallbacksOfAStep) {
    uint64_t hashes[2];
    for (const uint32_t threads : {1u, 4u}) {
        TestWorld world({}, threads);
        const BodyId floor = world.AddFloor();
        std::vector<BodyId> eggs;
        for (int i = 0; i < 60; ++i)
            eggs.push_back(
                world.Add({.shape = SphereOf(0.2f), .position = {0.5 * (i % 8), 0.5 + 0.1 * i, 0.5 * (i / 8)}}));
        samples::EditQueue queue;
        const Bursting listener(queue, floor);
        world.System().SetContactListener(&listener);
        for (int step = 0; step < 60; ++step) {
            world.Step();
            queue.Apply(world.System());
        }
        int left = 0;
        for (const BodyId egg : eggs) left += world.Bodies().Exists(egg);
        EXPECT_GT(left, 0);
        EXPECT_LT(left, 60);
        hashes[threads > 1] = world.System().HashState();
        world.System().SetContactListener(nullptr);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(EditQueue, IsFilledWhileTheWorldSteps) {
    TestWorld world({}, 2);
    world.AddFloor();
    samples::EditQueue queue;
    std::thread loader([&] {
        for (int i = 0; i < 50; ++i) {
            queue.Add([i](PhysicsSystem& system) {
                EXPECT_TRUE(system.Bodies().Create({.shape = SphereOf(0.2f), .position = {0.5 * i, 1, 0}}));
            });
            PointJointSettings joint;
            joint.bodyA = kWorldBody;
            joint.bodyB = BodyBatch::Body(0);
            joint.anchorA.point = {0.5 * i, 4, 0};
            const Result<BodyBatch> lamp =
                BodyBatch::Prepare({{.shape = SphereOf(0.1f), .position = {0.5 * i, 3, 0}}}, {joint});
            ASSERT_TRUE(lamp);
            queue.Add([lamp](PhysicsSystem& system) { EXPECT_TRUE(system.Bodies().Commit(lamp.Value())); });
        }
    });
    for (int step = 0; step < 20; ++step) {
        world.Step();
        queue.Apply(world.System());
    }
    loader.join();
    queue.Apply(world.System());
    world.Step();
    EXPECT_EQ(world.Report().bodies, 101u);
    EXPECT_EQ(world.Report().joints, 50u);
}

}  // namespace
}  // namespace fulcrum::testing
