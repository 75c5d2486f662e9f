// Job systems that programs bring: what they promise, and that the engine computes the same bits with them.
#include <Fulcrum/Samples/Embedding/SingleThreadJobs.h>
#ifdef FULCRUM_HAS_TBB
#include <Fulcrum/Samples/Embedding/TbbJobs.h>
#endif
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

namespace fulcrum::testing {
namespace {

// A pile that falls, of 300 bodies.
uint64_t HashOfAPile(JobSystem* jobs) {
    const std::unique_ptr<PhysicsSystem> system = PhysicsSystem::Create({}, jobs).Value();
    EXPECT_TRUE(system->Bodies().Create(
        {.shape = BoxOf(20, 0.5f, 20), .motion = MotionType::Static, .position = {0, -0.5, 0}}));
    const ShapePtr shapes[2] = {CubeOf(0.3f), SphereOf(0.3f)};
    for (int i = 0; i < 300; ++i)
        EXPECT_TRUE(system->Bodies().Create(
            {.shape = shapes[i % 2], .position = {0.5 * (i % 6), 0.5 + 0.7 * (i / 36), 0.5 * (i / 6 % 6)}}));
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(system->Update(kStep));
    return system->HashState();
}

// Every item once, in ranges long enough, no worker twice at a time.
void ExpectContract(JobSystem& jobs) {
    for (const uint32_t count : {0u, 1u, 7u, 64u, 1000u, 20011u}) {
        for (const uint32_t minimumRange : {0u, 1u, 5u, 64u, 5000u}) {
            std::vector<uint32_t> timesRun(count, 0);
            std::vector<std::atomic<bool>> isBusy(jobs.WorkerCount());
            std::atomic<uint32_t> wrong{0};
            jobs.ParallelFor(count, minimumRange, [&](JobRange range) {
                wrong += range.worker >= jobs.WorkerCount() || isBusy[range.worker].exchange(true);
                wrong += range.end - range.begin < minimumRange && range.end != count;
                for (uint32_t i = range.begin; i < range.end; ++i) ++timesRun[i];
                isBusy[range.worker] = false;
            });
            EXPECT_EQ(wrong, 0u) << count << ", " << minimumRange;
            for (const uint32_t times : timesRun) ASSERT_EQ(times, 1u);
        }
    }
    for (int i = 0; i < 100; ++i) {
        std::vector<std::atomic<uint32_t>> timesRun(jobs.WorkerCount());
        const std::thread::id caller = std::this_thread::get_id();
        std::atomic<bool> ranOnCaller{false};
        jobs.RunOnWorkers([&](uint32_t worker) {
            ++timesRun[worker];
            if (std::this_thread::get_id() == caller) ranOnCaller = true;
        });
        EXPECT_TRUE(ranOnCaller);
        for (const std::atomic<uint32_t>& times : timesRun) EXPECT_LE(times, 1u);
    }
}

TEST(SingleThreadJobs, KeepsTheContractAndTheBits) {
    samples::SingleThreadJobs jobs;
    ExpectContract(jobs);
    ThreadPool pool(4);
    EXPECT_EQ(HashOfAPile(&jobs), HashOfAPile(&pool));
}

#ifdef FULCRUM_HAS_TBB
TEST(TbbJobs, KeepsTheContractAndTheBits) {
    for (const uint32_t threads : {1u, 2u, 4u}) {
        samples::TbbJobs jobs(threads);
        EXPECT_EQ(jobs.WorkerCount(), threads);
        ExpectContract(jobs);
    }
    samples::TbbJobs jobs(4);
    EXPECT_EQ(HashOfAPile(&jobs), HashOfAPile(nullptr));
}

// From several threads and from inside of jobs, as a game's tasks would call it.
TEST(TbbJobs, MayBeCalledFromJobsAndFromManyThreads) {
    samples::TbbJobs jobs(4);
    std::atomic<uint32_t> sum{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 3; ++t)
        threads.emplace_back([&] {
            for (int i = 0; i < 50; ++i)
                jobs.ParallelFor(8, 1, [&](JobRange outer) {
                    for (uint32_t k = outer.begin; k < outer.end; ++k)
                        jobs.ParallelFor(16, 4, [&](JobRange inner) { sum += inner.end - inner.begin; });
                });
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(sum, 3u * 50 * 8 * 16);
}
#endif

}  // namespace
}  // namespace fulcrum::testing
