// The first queries after bodies were created come from several threads: one of them puts the trees in order, the
// others wait for it.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <atomic>
#include <thread>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr int kSide = 40;
constexpr int kThreads = 4, kQueries = 8;

// A layer of sleeping boxes, kSide x kSide, 1.1 m apart, all over the place in the order of their creation.
void AddLayer(TestWorld& world) {
    const ShapePtr box = CubeOf(0.5f);
    for (int i = 0; i < kSide * kSide; ++i) {
        const int place = i * 773 % (kSide * kSide);  // each once: 773 is prime
        world.Add({.shape = box, .position = {1.1 * (place % kSide), 0.5, 1.1 * (place / kSide)}, .startAsleep = true});
    }
}

std::vector<OverlapHit> OverlapsAt(TestWorld& world, int i) {
    const ShapePtr box = CubeOf(0.5f);
    std::vector<OverlapHit> hits;
    world.System().Queries().FindOverlaps(
        {box.get(), {{1.1 * (7 * i % kSide) + 0.3, 0.6, 1.1 * (13 * i % kSide) + 0.2}, {}}}, hits);
    return hits;
}

TEST(FirstQuery, MayComeFromSeveralThreads) {
    TestWorld world, one;
    AddLayer(world);
    AddLayer(one);
    std::vector<std::vector<OverlapHit>> found(kQueries);
    std::atomic<int> ready{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < kThreads; ++t)
        threads.emplace_back([&, t] {
            ++ready;
            while (ready < kThreads) std::this_thread::yield();
            for (int i = t; i < kQueries; i += kThreads) found[static_cast<size_t>(i)] = OverlapsAt(world, i);
        });
    for (std::thread& thread : threads) thread.join();
    for (int i = 0; i < kQueries; ++i) EXPECT_EQ(found[static_cast<size_t>(i)], OverlapsAt(one, i));
}

}  // namespace
}  // namespace fulcrum::testing
