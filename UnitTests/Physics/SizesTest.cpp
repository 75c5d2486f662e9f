// Small and large worlds: what an empty one takes, how long many bodies take to create, and that a million of them run.
// Ids of what was removed stay invalid until the counter of their index is used up, and then the index is.
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <set>

namespace fulcrum::testing {
namespace {

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(Sizes, AnEmptyWorldIsBelowAMegabyte) {
    const size_t before = AllocatedBytes();
    const auto system = PhysicsSystem::Create().Value();
    ASSERT_TRUE(system->Update(kStep));
    EXPECT_LT(system->MemoryUsed(), size_t{1} << 20);
    // With what it does not count: the threads' and the lock's.
    EXPECT_LT(AllocatedBytes() - before, size_t{1} << 20);
}

// Crates on the squares of a plane, so that there is nothing to find but them.
std::vector<BodySettings> Crates(int count, MotionType motion, const ShapePtr& shape) {
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    std::vector<BodySettings> crates(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i)
        crates[static_cast<size_t>(i)] = {
            .shape = shape, .motion = motion, .position = {2.0 * (i % side), 0.5, 2.0 * (i / side)}};
    return crates;
}

// CPU time of a batch of so many, the least of several, against that of a sort of ten times as many numbers and of
// writing to as much new memory as the world uses: what a page fault costs differs by a factor of ten among machines.
double RelativeTimeOfBatch(int count) {
    double leastBatch = 1e9, leastOther = 1e9;
    for (int attempt = 0; attempt < 3; ++attempt) {
        TestWorld world;
        const BodyBatch batch = BodyBatch::Prepare(Crates(count, MotionType::Dynamic, CubeOf(0.5f))).Value();
        double begin = CpuSeconds();
        EXPECT_EQ(world.Bodies().Commit(batch).Value().bodies.size(), static_cast<size_t>(count));
        leastBatch = std::min(leastBatch, CpuSeconds() - begin);
        begin = CpuSeconds();
        std::vector<uint32_t> numbers(static_cast<size_t>(count) * 10);
        for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i * 2654435761u;
        std::sort(numbers.begin(), numbers.end());
        const std::vector<char> memory(world.System().MemoryUsed(), 1);
        leastOther = std::min(leastOther, CpuSeconds() - begin);
    }
    return leastBatch / leastOther;
}

TEST(Sizes, AHundredThousandBodiesAreCreatedAtOnce) {
    const double small = RelativeTimeOfBatch(Cases(10'000)), large = RelativeTimeOfBatch(Cases(100'000));
    if (kIsSanitized) return;  // the sort does not allocate
    EXPECT_LT(large, 2);
    EXPECT_LT(large, 5 * small);  // in proportion; what does not fit a cache takes longer
}

// CPU time of 30 steps in which balls fall onto some of so many static crates.
double TimeOfBallsOn(int statics, int actives) {
    TestWorld world;
    const ShapePtr crate = CubeOf(0.5f), ball = SphereOf(0.3f);
    EXPECT_TRUE(world.Bodies().Commit(BodyBatch::Prepare(Crates(statics, MotionType::Static, crate)).Value()));
    EXPECT_LT(static_cast<double>(world.System().MemoryUsed()), 1400.0 * statics);
    std::vector<BodySettings> balls = Crates(actives, MotionType::Dynamic, ball);
    const int side = static_cast<int>(std::ceil(std::sqrt(statics)));
    for (int i = 0; i < actives; ++i)  // a hand's breadth above the crates
        balls[static_cast<size_t>(i)].position = {2.0 * (i % side), 1.35, 2.0 * (i / side)};
    const std::vector<BodyId> ids = world.Bodies().Commit(BodyBatch::Prepare(std::move(balls)).Value()).Value().bodies;
    world.Step();
    const double begin = CpuSeconds();
    world.Steps(30);
    const double seconds = CpuSeconds() - begin;
    for (const BodyId id : ids) EXPECT_NEAR(world.PositionOf(id).y(), 1.3, 0.005) << id.index;
    return seconds;
}

TEST(Sizes, AMillionStaticBodiesAndTenThousandActiveOnesRun) {
    const int statics = Cases(1'000'000), actives = Cases(10'000);
    const double few = TimeOfBallsOn(actives, actives), many = TimeOfBallsOn(statics, actives);
    EXPECT_TRUE(kIsSanitized || many < 3 * few) << many << " s, " << few;  // what does not move is no work
}

// ---- Ids. The counter of an index has 32 bits; these begin shortly before its end.

TEST(Ids, OfRemovedBodiesNeverComeBack) {
    TestWorld world;
    const BodyId first = world.Add({.shape = SphereOf(1)});
    ASSERT_TRUE(world.Bodies().Remove(first));
    world.Step();
    constexpr uint32_t kLeft = 3;
    WorldOf(world.System()).bodies.cold[first.index].generation = 0u - kLeft;
    std::set<BodyId> ids;
    std::vector<BodyId> sameIndex;
    for (int i = 0; i < 10; ++i) {
        const BodyId id = world.Add({.shape = SphereOf(1), .position = {0, 1.0 * i, 0}});
        EXPECT_TRUE(ids.insert(id).second) << id.index << " " << id.generation;
        if (id.index == first.index) sameIndex.push_back(id);
        for (const BodyId other : ids) EXPECT_EQ(world.Bodies().Exists(other), other == id);
        std::vector<std::byte> snapshot;
        ASSERT_TRUE(world.System().SaveSnapshot(snapshot));
        const uint64_t hash = world.System().HashState();
        ASSERT_TRUE(world.System().RestoreSnapshot(snapshot));
        EXPECT_EQ(world.System().HashState(), hash);
        ASSERT_TRUE(world.Bodies().Remove(id));
        world.Step();
    }
    EXPECT_EQ(sameIndex.size(), kLeft);
    EXPECT_FALSE(world.Bodies().Exists(first));
}

TEST(Ids, OfRemovedJointsNeverComeBack) {
    TestWorld world;
    PointJointSettings settings;
    settings.bodyA = kWorldBody;
    settings.bodyB = world.Add({.shape = SphereOf(1)});
    JointInterface& joints = world.System().Joints();
    const JointId first = joints.Create(settings).Value();
    ASSERT_TRUE(joints.Remove(first));
    constexpr uint32_t kLeft = 3;
    WorldOf(world.System()).joints.joints[first.index].generation = 0u - kLeft;
    std::set<JointId> ids;
    size_t sameIndex = 0;
    for (int i = 0; i < 10; ++i) {
        const JointId id = joints.Create(settings).Value();
        EXPECT_TRUE(ids.insert(id).second) << id.index << " " << id.generation;
        sameIndex += id.index == first.index;
        for (const JointId other : ids) EXPECT_EQ(joints.Exists(other), other == id);
        world.Step();
        ASSERT_TRUE(joints.Remove(id));
    }
    EXPECT_EQ(sameIndex, kLeft);
    EXPECT_FALSE(joints.Exists(first));
}

}  // namespace
}  // namespace fulcrum::testing
