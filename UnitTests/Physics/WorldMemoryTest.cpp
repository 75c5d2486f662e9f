// A world in memory of the program's own: everything comes from it and goes back to it, and steps in a steady state ask
// for nothing.
#include <Fulcrum/Samples/Embedding/PmrMemory.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <atomic>
#include <cstdlib>
#include <limits>
#include <memory_resource>

namespace fulcrum::testing {
namespace {

// By malloc, so that operator new is not called. Each piece knows its size and alignment, which must come back.
class CountingMemory final : public MemoryResource {
public:
    ~CountingMemory() override { EXPECT_EQ(bytes_, 0); }

    void* Allocate(size_t bytes, size_t alignment) override {
        const size_t head = std::max(alignment, sizeof(Piece));
        char* memory = static_cast<char*>(std::aligned_alloc(head, (head + bytes + head - 1) / head * head));
        if (!memory) throw std::bad_alloc();
        *reinterpret_cast<Piece*>(memory + head - sizeof(Piece)) = {bytes, alignment};
        bytes_ += static_cast<int64_t>(bytes);
        ++calls_;
        return memory + head;
    }
    void Deallocate(void* memory, size_t bytes, size_t alignment) override {
        char* begin = static_cast<char*>(memory);
        const Piece piece = *reinterpret_cast<Piece*>(begin - sizeof(Piece));
        EXPECT_EQ(piece.bytes, bytes);
        EXPECT_EQ(piece.alignment, alignment);
        bytes_ -= static_cast<int64_t>(bytes);
        std::free(begin - std::max(alignment, sizeof(Piece)));
    }
    int64_t Bytes() const { return bytes_; }
    uint64_t Calls() const { return calls_; }

private:
    struct Piece {
        size_t bytes, alignment;
    };
    std::atomic<int64_t> bytes_{0};
    std::atomic<uint64_t> calls_{0};
};

// Shapes may outlive the world, so they are not its memory.
struct Parts {
    ShapePtr floor = BoxOf(50, 0.5f, 50), cube = CubeOf(0.3f), ball = SphereOf(0.3f),
             hull = HullOf({{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}, {0.5f, 0.5f, 0.5f}}),
             pair = CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}});
};

SystemSettings AllEvents() {
    SystemSettings settings;
    settings.events.contacts = settings.events.bodies = true;
    settings.measuresErrors = true;
    return settings;
}

// A pile of everything: all kinds of bodies, joints, a sensor, a belt of kinematic bodies.
void Fill(PhysicsSystem& system, const Parts& parts) {
    RandomPoses random(5);
    ASSERT_TRUE(system.Bodies().Create({.shape = parts.floor, .motion = MotionType::Static, .position = {0, -0.5, 0}}));
    const ShapePtr* const shapes[] = {&parts.cube, &parts.ball, &parts.hull, &parts.pair};
    BodyId last;
    for (int i = 0; i < 80; ++i) {
        const Vector3 at = random.InBox(2);
        const BodyId id =
            system.Bodies()
                .Create({.shape = *shapes[i % 4],
                         .position = (at + Vector3(0, 3, 0)).cast<double>(),
                         .rotation = random.Rotation(),
                         .category = i % 9 == 0 ? 2u : 1u,
                         .continuous = i % 5 == 0 ? ContinuousCollision::Linear : ContinuousCollision::Off})
                .Value();
        if (i % 6 == 1) {
            HingeJointSettings hinge;
            hinge.bodyA = last;
            hinge.bodyB = id;
            ASSERT_TRUE(system.Joints().Create(hinge));
        }
        if (i % 6 == 2) {
            SixDofJointSettings six;
            six.bodyA = kWorldBody;
            six.bodyB = id;
            ASSERT_TRUE(system.Joints().Create(six));
        }
        last = id;
    }
    ASSERT_TRUE(system.Bodies().Create(
        {.shape = parts.cube, .motion = MotionType::Static, .position = {0, 1, 0}, .isSensor = true}));
}

TEST(WorldMemory, NothingGoesPastIt) {
    const Parts parts;
    ThreadPool jobs(3);
    CountingMemory memory;
    std::vector<std::byte> snapshot;
    std::vector<Ray> rays(100, Ray{{0, 10, 0}, {0, -20, 0}});
    std::vector<WorldRayHit> hits(100);
    std::vector<WorldContact> contacts;
    for (const bool counts : {false, true}) {  // the first time fills the buffers of threads and of this test
        const uint64_t before = AllocationCount();
        {
            auto system = PhysicsSystem::Create(AllEvents(), &jobs, &memory).Value();
            Fill(*system, parts);
            for (int step = 0; step < 100; ++step) {
                ASSERT_TRUE(system->Update(kStep));
                system->Queries().CastRays(rays, hits);
                system->Queries().CollideShape({parts.cube.get(), {{0, 0.2, 0}, {}}}, 0.1f, contacts);
            }
            ASSERT_TRUE(system->SaveSnapshot(snapshot));
            EXPECT_NE(system->HashState(), 0u);
            ASSERT_TRUE(system->RestoreSnapshot(snapshot));
            system->VisitIslands([](BodyId, uint32_t) {});
            system->VisitBodies([&](BodyId id) {
                if (id.index % 3 == 0) {
                    EXPECT_TRUE(system->Bodies().Remove(id));
                }
            });
            for (int step = 0; step < 20; ++step) ASSERT_TRUE(system->Update(kStep));
            EXPECT_GT(memory.Bytes(), 100'000);
        }
        EXPECT_EQ(memory.Bytes(), 0);
        if (counts) {
            EXPECT_EQ(AllocationCount() - before, 0u);
        }
    }
}

// As MemoryUsed says, but for types of joints, whose sizes it does not know, and the objects around the buffers.
TEST(WorldMemory, IsWhatMemoryUsedSays) {
    const Parts parts;
    CountingMemory memory;
    auto system = PhysicsSystem::Create(AllEvents(), nullptr, &memory).Value();
    Fill(*system, parts);
    for (int step = 0; step < 50; ++step) ASSERT_TRUE(system->Update(kStep));
    const auto used = static_cast<int64_t>(system->MemoryUsed());
    EXPECT_GE(memory.Bytes(), used);
    EXPECT_LE(memory.Bytes(), used + 12'288 + 27 * 640);
}

TEST(WorldMemory, AStepInASteadyStateAsksForNothing) {
    const Parts parts;
    for (const uint32_t threads : {1u, 3u}) {
        ThreadPool jobs(threads);
        CountingMemory memory;
        SystemSettings settings = AllEvents();
        settings.sleep.enabled = false;
        auto system = PhysicsSystem::Create(settings, &jobs, &memory).Value();
        Fill(*system, parts);
        // A bar that stirs them for ever.
        ASSERT_TRUE(system->Bodies().Create({.shape = BoxOf(3, 0.2f, 0.2f),
                                             .motion = MotionType::Kinematic,
                                             .position = {0, 0.4, 0},
                                             .angularVelocity = Vector3(0, 2, 0)}));
        for (int step = 0; step < 600; ++step) ASSERT_TRUE(system->Update(kStep));
        const uint64_t calls = memory.Calls(), news = AllocationCount();
        for (int step = 0; step < 200; ++step) ASSERT_TRUE(system->Update(kStep));
        const uint64_t newsAfter = AllocationCount();
        EXPECT_EQ(newsAfter, news);
        EXPECT_LE(memory.Calls() - calls, 2u) << threads << " threads";  // a list may reach a new length
    }
}

// Buffers never shrink: a level that was full once, as while it loads, takes as many bodies again with hardly more
// memory, for the batch as in the steps that follow.
TEST(WorldMemory, IsThereWhereTheWorldHasBeenAsFull) {
    const Parts parts;
    CountingMemory memory;
    SystemSettings settings;
    settings.accuracy.penetration = std::numeric_limits<float>::infinity();  // how many stacks get effort is chance
    auto system = PhysicsSystem::Create(settings, nullptr, &memory).Value();
    ASSERT_TRUE(
        system->Bodies().Create({.shape = parts.floor, .motion = MotionType::Static, .position = {0, -0.5, 0}}));
    const auto crates = [&](double x) {
        std::vector<BodySettings> bodies;
        for (int i = 0; i < 600; ++i)
            bodies.push_back(
                {.shape = parts.cube, .position = {x + 0.65 * (i % 10), 0.3 + 0.62 * (i / 100), 0.65 * (i / 10 % 10)}});
        return BodyBatch::Prepare(std::move(bodies)).Value();
    };
    ASSERT_TRUE(system->Bodies().Commit(crates(-20)));
    ASSERT_TRUE(system->Update(kStep));  // the lists of the first step with many contacts are not kept
    const BodyBatch more = crates(10);
    int64_t full = 0;
    for (const bool isAgain : {false, true}) {
        const int64_t before = memory.Bytes();
        const std::vector<BodyId> ids = system->Bodies().Commit(more).Value().bodies;
        // The first time it gets as full as it will be.
        for (int step = 0; step < (isAgain ? 20 : 100); ++step) ASSERT_TRUE(system->Update(kStep));
        if (isAgain) break;
        full = memory.Bytes();
        EXPECT_GT(full, before + before / 4);
        for (const BodyId id : ids) ASSERT_TRUE(system->Bodies().Remove(id));
        for (int step = 0; step < 20; ++step) ASSERT_TRUE(system->Update(kStep));
    }
    EXPECT_LE(memory.Bytes(), full + full / 20);  // the list of new contacts is as long as that of one step
}

TEST(WorldMemory, WorldsDoNotShareIt) {
    const Parts parts;
    CountingMemory first, second;
    auto a = PhysicsSystem::Create({}, nullptr, &first).Value();
    auto b = PhysicsSystem::Create({}, nullptr, &second).Value();
    auto plain = PhysicsSystem::Create().Value();
    Fill(*a, parts);
    const int64_t ofA = first.Bytes();
    Fill(*b, parts);
    Fill(*plain, parts);
    for (int step = 0; step < 30; ++step) {
        ASSERT_TRUE(b->Update(kStep));
        ASSERT_TRUE(plain->Update(kStep));
    }
    EXPECT_EQ(first.Bytes(), ofA);
    EXPECT_EQ(b->HashState(), plain->HashState());
    // What one saved the other one restores, in its own memory.
    std::vector<std::byte> snapshot;
    ASSERT_TRUE(b->SaveSnapshot(snapshot));
    const int64_t ofB = second.Bytes();
    ASSERT_TRUE(a->RestoreSnapshot(snapshot));
    EXPECT_EQ(second.Bytes(), ofB);
    EXPECT_EQ(a->HashState(), b->HashState());
    b = nullptr;
    EXPECT_EQ(second.Bytes(), 0);
    for (int step = 0; step < 30; ++step) {
        ASSERT_TRUE(a->Update(kStep));
        ASSERT_TRUE(plain->Update(kStep));
    }
    EXPECT_EQ(a->HashState(), plain->HashState());
}

TEST(WorldMemory, FromAPmrResource) {
    const Parts parts;
    std::pmr::synchronized_pool_resource pool;
    samples::PmrMemory memory(pool);
    ThreadPool jobs(2);
    auto pooled = PhysicsSystem::Create({}, &jobs, &memory).Value();
    auto plain = PhysicsSystem::Create().Value();
    Fill(*pooled, parts);
    Fill(*plain, parts);
    for (int step = 0; step < 60; ++step) {
        ASSERT_TRUE(pooled->Update(kStep));
        ASSERT_TRUE(plain->Update(kStep));
    }
    EXPECT_EQ(pooled->HashState(), plain->HashState());
}

}  // namespace
}  // namespace fulcrum::testing
