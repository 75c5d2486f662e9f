// What the first query and the first step after the creation of many bodies have to do: the first query puts the trees
// in order, once; a step has nothing to do with bodies that sleep or never move, until its own searches have cost as
// much as that. Counted by the nodes that a line visits (BoundsTree::Cost), not by the clock.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr int kSide = 40;

// A layer of boxes, kSide x kSide, 1.1 m apart, all over the place in the order of their creation.
int PlaceOf(int i) { return i * 773 % (kSide * kSide); }  // each once: 773 is prime
void AddLayer(TestWorld& world, MotionType motion) {
    const ShapePtr box = CubeOf(0.5f);
    for (int i = 0; i < kSide * kSide; ++i)
        world.Add({.shape = box,
                   .motion = motion,
                   .position = {1.1 * (PlaceOf(i) % kSide), 0.5, 1.1 * (PlaceOf(i) / kSide)},
                   .startAsleep = motion == MotionType::Dynamic});
}

std::vector<OverlapHit> OverlapsAt(TestWorld& world, int i) {
    const ShapePtr box = CubeOf(0.5f);
    std::vector<OverlapHit> hits;
    world.System().Queries().FindOverlaps(
        {box.get(), {{1.1 * (7 * i % kSide) + 0.3, 0.6, 1.1 * (13 * i % kSide) + 0.2}, {}}}, hits);
    return hits;
}

const ColliderStore& CollidersOf(TestWorld& world) { return WorldOf(world.System()).colliders; }

TEST(FirstQuery, FindsTheTreesInOrder) {
    for (const MotionType motion : {MotionType::Dynamic, MotionType::Static}) {
        TestWorld world, optimized;
        AddLayer(world, motion);
        AddLayer(optimized, motion);
        const auto treeOf = [&](TestWorld& of) -> const BoundsTree& {
            return motion == MotionType::Static ? CollidersOf(of).staticTree : CollidersOf(of).movingTree;
        };
        const float before = treeOf(world).Cost();
        optimized.System().Optimize();
        const float after = treeOf(optimized).Cost();
        EXPECT_GT(before, 2 * after);
        EXPECT_EQ(OverlapsAt(world, 1), OverlapsAt(optimized, 1));
        EXPECT_EQ(treeOf(world).Cost(), after);
        WorldRayHit hit;
        TestWorld cast;
        AddLayer(cast, motion);
        EXPECT_TRUE(cast.System().Queries().CastRay({{0.2, 5, 0.3}, {0, -10, 0}}, hit));
        EXPECT_EQ(treeOf(cast).Cost(), after);
    }
}

TEST(FirstStep, LeavesTreesOfSleepingBodiesAsTheyAre) {
    TestWorld world;
    AddLayer(world, MotionType::Dynamic);
    for (int i = 0; i < 4; ++i) world.Add({.shape = SphereOf(0.3f), .position = {5.0 * i, 30, 0}});
    const float before = CollidersOf(world).movingTree.Cost();
    EXPECT_LE(WorldOf(world.System()).bodies.placed.size(), 6u);  // those that are awake, and one that sleeps
    world.Step();
    EXPECT_GT(CollidersOf(world).movingTree.Cost(), 0.9f * before);
    // A query afterwards still puts it in order, and the next step does not undo that.
    (void)OverlapsAt(world, 1);
    const float after = CollidersOf(world).movingTree.Cost();
    EXPECT_LT(after, 0.5f * before);
    world.Step();
    EXPECT_LT(CollidersOf(world).movingTree.Cost(), 1.2f * after);
}

// Three tenths of as many searches as there are leaves cost as much as a rebuild.
TEST(FirstStep, RebuildsATreeThatItSearchesMuch) {
    TestWorld world;
    AddLayer(world, MotionType::Static);
    const float before = CollidersOf(world).staticTree.Cost();
    for (int i = 0; i < kSide * kSide / 2; ++i)
        world.Add({.shape = SphereOf(0.3f), .position = {1.1 * (i % kSide), 2, 1.1 * (i / kSide)}});
    world.Step();
    EXPECT_LT(CollidersOf(world).staticTree.Cost(), 0.5f * before);
}

// Static bodies that meet nothing that may move search for no pairs; those that do, do.
TEST(FirstStep, HasNothingToDoWithNewStaticBodies) {
    TestWorld world;
    AddLayer(world, MotionType::Static);
    EXPECT_TRUE(CollidersOf(world).moved.empty());
    EXPECT_TRUE(WorldOf(world.System()).bodies.placed.empty());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {3, 1.49, 3}});
    world.Step();
    EXPECT_EQ(CollidersOf(world).moved.size(), 0u);
    const BodyId lid = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {3, 2.45, 3}});
    EXPECT_EQ(CollidersOf(world).moved.size(), 1u);
    world.Step();
    int contacts = 0;
    world.System().VisitContactsOf(
        ball, [&](const ContactView& contact) { contacts += contact.bodyA == lid || contact.bodyB == lid; });
    EXPECT_EQ(contacts, 1);
}

TEST(Optimize, ChangesNoResults) {
    uint64_t hashes[2];
    for (const bool optimizes : {false, true}) {
        TestWorld world({}, optimizes ? 2u : 1u);
        AddLayer(world, MotionType::Static);
        AddLayer(world, MotionType::Dynamic);
        for (int i = 0; i < 60; ++i)
            world.Add({.shape = CubeOf(0.4f), .position = {1.3 * (i % 10), 2.2 + 0.01 * i, 1.7 * (i / 10)}});
        if (optimizes) world.System().Optimize();
        world.Steps(20);
        hashes[optimizes] = world.System().HashPoses();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

// The tree does not depend on the threads that build it.
TEST(Optimize, BuildsTheSameTreeInParallel) {
    for (const uint32_t count : {5u, 100u, 2049u, 10000u}) {
        BoundsTree serial, parallel;
        uint32_t random = 1;
        const auto next = [&] { return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) * 6e-6f; };
        for (uint32_t id = 0; id < count; ++id) {
            Bounds box;
            box.lower = Vector3(next(), next(), next());
            box.upper = box.lower + Vector3::Constant(id % 1000 == 0 ? 60.0f : 0.5f);
            serial.Insert(id, box);
            parallel.Insert(id, box);
        }
        serial.Rebuild();
        parallel.Rebuild([](uint32_t parts, const Function<void(uint32_t)>& job) {
            std::thread other([&] {
                for (uint32_t i = 1; i < parts; i += 2) job(i);
            });
            for (uint32_t i = 0; i < parts; i += 2) job(i);
            other.join();
        });
        serial.Validate();
        parallel.Validate();
        EXPECT_EQ(serial.Cost(), parallel.Cost());
        std::vector<uint32_t> order[2];
        const Bounds all = serial.TotalBounds();
        serial.Query(all, [&](uint32_t id) { order[0].push_back(id); });
        parallel.Query(all, [&](uint32_t id) { order[1].push_back(id); });
        EXPECT_EQ(order[0].size(), count);
        EXPECT_EQ(order[0], order[1]);
    }
}

}  // namespace
}  // namespace fulcrum::testing
