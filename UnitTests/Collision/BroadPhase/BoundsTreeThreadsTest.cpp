// A tree that several threads build is the one that a single thread builds.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace fulcrum::testing {
namespace {

Bounds RandomBounds(RandomPoses& random, float half) {
    const Vector3 center = random.InBox(100);
    const float x = random.Between(0, half), y = random.Between(0, half), z = random.Between(0, half);
    Bounds bounds;
    bounds.lower = center - Vector3(x, y, z);
    bounds.upper = center + Vector3(x, y, z);
    return bounds;
}

// Parts of a tree that are built at the same time have nodes above them in common: where both wrote the masks of these,
// trees lost branches.
TEST(BoundsTreeThreads, BuildTheTreeOfOneThread) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const Bounds all{Vector3(-kInfinity, -kInfinity, -kInfinity), Vector3(kInfinity, kInfinity, kInfinity)};
    ThreadPool pool(4);
    const ParallelLoop parallel = [&](uint32_t count, const Function<void(uint32_t)>& job) {
        pool.ParallelFor(count, 1, [&](JobRange range) {
            for (uint32_t i = range.begin; i < range.end; ++i) job(i);
        });
    };
    RandomPoses random(1);
    for (const uint32_t count : {2500u, 5000u, 5003u, 40000u})
        for (const uint32_t large : {0u, 2u, 30u}) {
            std::vector<Bounds> leaves(count);
            for (uint32_t i = 0; i < count; ++i)
                leaves[i] = RandomBounds(random, i % (count / 30) < large / 15 ? 90.0f : 1.0f);
            const auto insertInto = [&](BoundsTree& tree) {
                for (uint32_t i = 0; i < count; ++i) tree.Insert(i, leaves[i]);
            };
            BoundsTree alone;
            insertInto(alone);
            alone.Rebuild();
            std::vector<uint32_t> wanted;
            alone.Query(all, [&](uint32_t id) { wanted.push_back(id); });
            EXPECT_EQ(wanted.size(), count);
            for (int times = Cases(20); times > 0; --times) {
                BoundsTree together;
                insertInto(together);
                together.Rebuild(parallel);
                together.Validate();
                std::vector<uint32_t> found;
                together.Query(all, [&](uint32_t id) { found.push_back(id); });
                ASSERT_EQ(found, wanted) << count << " leaves, " << large << " large";
                ASSERT_EQ(together.Cost(), alone.Cost());
            }
        }
}

}  // namespace
}  // namespace fulcrum::testing
