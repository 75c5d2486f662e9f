// Costs of a world at rest: no allocations, little memory, no work for sleeping bodies.
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

void AddPyramid(TestWorld& world, int base) {
    world.AddFloor();
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            world.Add({.shape = CubeOf(0.5f), .position = {i + 0.5 * row, 0.5 + row, 0}});
}

uint64_t AllocationsOfSettledSteps(TestWorld& world) {
    world.Steps(200);
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 100; ++i) {
        const Status status = world.System().Update(kStep);
        if (!status) ADD_FAILURE();
    }
    return AllocationCount() - before;
}

TEST(Cost, TheCounterCounts) {
    const uint64_t before = AllocationCount();
    const auto number = std::make_unique<int>(1);
    EXPECT_EQ(AllocationCount() - before, 1u);
}

TEST(Cost, ASettledStepAllocatesNothing) {
    for (uint32_t threads : {1u, 2u}) {
        TestWorld world(NoSleep(), threads);
        AddPyramid(world, 12);
        EXPECT_EQ(AllocationsOfSettledSteps(world), 0u) << threads << " threads";
        EXPECT_GT(world.Report().awakeBodies, 0u);
    }
}

TEST(Cost, SettledHullsCapsulesAndOverflowAllocateNothing) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const ShapePtr hull =
        HullOf({{0.4f, -0.4f, 0.4f}, {-0.4f, -0.4f, 0.4f}, {0.4f, -0.4f, -0.4f}, {-0.4f, -0.4f, -0.4f}, {0, 0.4f, 0}});
    world.Add({.shape = BoxOf(6, 0.25f, 6), .position = {0, 0.25, 0}, .mass = 1000});
    for (int i = 0; i < 100; ++i) {
        const double x = i % 10 * 1.0 - 4.5, z = i / 10 * 1.0 - 4.5;
        if (i % 2) world.Add({.shape = hull, .position = {x, 0.9, z}});
        else
            world.Add({.shape = CapsuleOf(0.3f, 0.2f),
                       .position = {x, 0.7, z},
                       .rotation = RotationAbout({0, 0, 1}, kPi / 2)});
    }
    EXPECT_EQ(AllocationsOfSettledSteps(world), 0u);
    EXPECT_GT(world.Report().overflowConstraints, 0u);
}

// As do those of which all events are listed, whichever worker finds them; a ball bounces all the while.
TEST(Cost, ASettledStepWithEventsAllocatesNothing) {
    for (uint32_t threads : {1u, 2u}) {
        SystemSettings settings = NoSleep();
        settings.events = {.contacts = true, .stays = true, .bodies = true};
        TestWorld world(settings, threads);
        AddPyramid(world, 12);
        world.Add({.shape = SphereOf(0.2f),
                   .position = {0, 3, 8},
                   .linearVelocity = {0, -40, 0},
                   .material = {.restitution = 1},
                   .continuous = ContinuousCollision::Linear});
        EXPECT_EQ(AllocationsOfSettledSteps(world), 0u) << threads << " threads";
        EXPECT_GT(world.System().Events().contacts.size(), 100u);
        EXPECT_GT(world.System().Events().moved.size(), 0u);
    }
}

// 1.5 KB until positions got remainders (24 bytes) and pairs lists of their own colliders (16 a pair), 1.6 until
// contacts got a largest push of their own (4), and what they carry is noted (30).
TEST(Cost, ARestingBoxTakesAtMost1635Bytes) {
    TestWorld world(NoSleep());
    world.AddFloor();
    for (int i = 0; i < 1000; ++i)
        world.Add({.shape = CubeOf(0.5f), .position = {i % 32 * 2.0 - 32, 0.5, i / 32 * 2.0 - 32}});
    world.Steps(60);
    EXPECT_EQ(world.Report().contacts, 1000u);
    EXPECT_LE(static_cast<double>(world.System().MemoryUsed()) / 1000, 1635.0);
}

// Of a pair whose bounds overlap, but not its shapes: 64 bytes, in lists of its colliders (16), its entry in a hash
// table that is at least a quarter full (8), its load (4), index lists (9), and room for an eighth more.
TEST(Cost, APairWithoutContactTakesAtMost144Bytes) {
    constexpr int kCount = 20;
    SystemSettings settings = NoSleep();
    settings.gravity = Vector3::Zero();
    const auto memoryOf = [&](double distance) {
        TestWorld world(settings);
        for (int i = 0; i < kCount * kCount; ++i)
            world.Add({.shape = SphereOf(0.5f), .position = {i % kCount * distance, 0, i / kCount * distance}});
        world.Steps(10);
        EXPECT_EQ(world.Report().contacts, 0u);
        return std::pair(static_cast<double>(world.System().MemoryUsed()), world.Report().pairs);
    };
    const auto [far, none] = memoryOf(3);
    const auto [near, pairs] = memoryOf(1.06);  // bounds reach 5 cm farther, contacts 2
    EXPECT_EQ(none, 0u);
    EXPECT_GE(pairs, 2u * kCount * (kCount - 1));
    EXPECT_LE((near - far) / pairs, 144.0);
}

// What goes with a world but for its shapes: joints, sensors, bodies that are cast along their ways, events, several
// threads.
TEST(Cost, MemoryUsedIsWhatIsAllocated) {
    if (AllocatedBytes() == 0) GTEST_SKIP() << "the allocator does not say what it gave";
    SystemSettings settings = JointScene::Settings();
    settings.events = {.contacts = true, .stays = true, .bodies = true};
    auto world = std::make_unique<TestWorld>(settings, 2);
    std::vector<ShapePtr> shapes;
    {
        JointScene scene(*world);
        for (int i = 0; i < 200; ++i)
            world->Add({.shape = SphereOf(0.1f),
                        .position = {i % 20 * 1.0 - 10, 5.0 + i / 20, 30},
                        .linearVelocity = {0, -40, 0},
                        .continuous = ContinuousCollision::Linear});
        world->Add({.shape = CubeOf(8), .motion = MotionType::Static, .position = {0, 4, 30}, .isSensor = true});
        for (int step = 0; step < 60; ++step) {
            scene.BeforeStep(step);
            world->Step();
        }
        world->System().VisitBodies([&](BodyId id) { shapes.push_back(world->Bodies().GetShape(id)); });
    }
    const double used = static_cast<double>(world->System().MemoryUsed());
    const uint64_t before = AllocatedBytes();
    world.reset();
    const double freed = static_cast<double>(before - AllocatedBytes());
    EXPECT_GT(used, 0.95 * freed);
    EXPECT_LT(used, 1.05 * freed);
}

TEST(Cost, SleepersAreNoWork) {
    TestWorld world;
    AddPyramid(world, 10);
    world.Run(3);
    EXPECT_EQ(world.Report().awakeBodies, 0u);
    EXPECT_EQ(world.Report().pairs, 0u);
    EXPECT_EQ(world.Report().contacts, 0u);
    EXPECT_EQ(world.Report().colors, 0u);
}

}  // namespace
}  // namespace fulcrum::testing
