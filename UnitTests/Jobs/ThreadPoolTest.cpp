#include <Fulcrum/Jobs/ThreadPool.h>

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

namespace fulcrum {
namespace {

// Runs a ParallelFor and checks the contract of JobSystem: every item once, ranges long enough, workers told apart.
void ExpectEveryItemOnce(JobSystem& jobs, uint32_t count, uint32_t minimumRange) {
    std::vector<uint32_t> timesRun(count, 0);  // plain on purpose: the thread sanitizer sees an item that runs twice
    std::vector<std::atomic<bool>> workerIsBusy(jobs.WorkerCount());
    std::atomic<uint32_t> shortRanges{0}, clashes{0}, badRanges{0};
    jobs.ParallelFor(count, minimumRange, [&](JobRange range) {
        if (range.begin >= range.end || range.end > count || range.worker >= jobs.WorkerCount()) {
            ++badRanges;
            return;
        }
        if (workerIsBusy[range.worker].exchange(true)) ++clashes;
        if (range.end - range.begin < minimumRange && range.end != count) ++shortRanges;
        for (uint32_t i = range.begin; i < range.end; ++i) ++timesRun[i];
        workerIsBusy[range.worker] = false;
    });
    EXPECT_EQ(badRanges, 0u) << count << " items, ranges of " << minimumRange;
    EXPECT_EQ(clashes, 0u) << count << " items, ranges of " << minimumRange;
    EXPECT_EQ(shortRanges, 0u) << count << " items, ranges of " << minimumRange;
    for (uint32_t i = 0; i < count; ++i) ASSERT_EQ(timesRun[i], 1u) << "item " << i << " of " << count;
}

TEST(ThreadPool, RunsEveryItemOnce) {
    for (const uint32_t workers : {1u, 2u, 3u, 4u}) {
        ThreadPool pool(workers);
        EXPECT_EQ(pool.WorkerCount(), workers);
        for (const uint32_t count : {0u, 1u, 2u, 3u, 7u, 8u, 63u, 64u, 65u, 1000u, 20011u})
            for (const uint32_t minimumRange : {0u, 1u, 2u, 5u, 64u, 1000u, ~0u})
                ExpectEveryItemOnce(pool, count, minimumRange);
    }
}

TEST(ThreadPool, RunsEveryItemOnceInManyShortJobs) {
    ThreadPool pool(3);
    for (uint32_t i = 0; i < 5000; ++i) ExpectEveryItemOnce(pool, i % 37, 1 + i % 3);
}

TEST(ThreadPool, FinishesWithMoreWorkersThanCores) {
    ThreadPool pool(16);
    for (uint32_t i = 0; i < 20; ++i) ExpectEveryItemOnce(pool, 500, 1);
}

TEST(ThreadPool, ClampsTheNumberOfWorkers) {
    EXPECT_EQ(ThreadPool(0).WorkerCount(), 1u);
    EXPECT_LE(ThreadPool(100000).WorkerCount(), ThreadPool::kMaximumWorkers);
}

TEST(ThreadPool, DoesNothingForNoItems) {
    ThreadPool pool(2);
    pool.ParallelFor(0, 1, [](JobRange) { FAIL(); });
}

TEST(ThreadPool, RunsAFewItemsAsOneRangeOnTheCaller) {
    ThreadPool pool(4);
    uint32_t calls = 0;
    pool.ParallelFor(10, 10, [&](JobRange range) {
        ++calls;
        EXPECT_EQ(range.begin, 0u);
        EXPECT_EQ(range.end, 10u);
        EXPECT_EQ(range.worker, 0u);
    });
    EXPECT_EQ(calls, 1u);
}

TEST(ThreadPool, SpreadsALongJobOverItsWorkers) {
    ThreadPool pool(2);
    std::atomic<uint32_t> arrived{0};
    // Each of two items waits for the other, so the job ends only if two threads run them.
    pool.ParallelFor(2, 1, [&](JobRange) {
        ++arrived;
        while (arrived < 2) std::this_thread::yield();
    });
    EXPECT_EQ(arrived, 2u);
}

TEST(ThreadPool, NestedJobsRunOnTheirOwnThreadUnderItsWorker) {
    ThreadPool pool(4);
    std::atomic<uint32_t> sum{0}, strangers{0};
    pool.ParallelFor(64, 1, [&](JobRange outer) {
        const auto thread = std::this_thread::get_id();
        for (uint32_t i = outer.begin; i < outer.end; ++i) {
            pool.ParallelFor(100, 1, [&](JobRange inner) {
                if (inner.worker != outer.worker || std::this_thread::get_id() != thread) ++strangers;
                sum += inner.end - inner.begin;
            });
            pool.RunOnWorkers([&](uint32_t worker) {
                if (worker != outer.worker || std::this_thread::get_id() != thread) ++strangers;
            });
        }
    });
    EXPECT_EQ(sum, 6400u);
    EXPECT_EQ(strangers, 0u);
}

TEST(ThreadPool, AJobOfOnePoolMayUseAnother) {
    ThreadPool first(3), second(2);
    std::atomic<uint32_t> sum{0}, strangers{0};
    first.ParallelFor(50, 1, [&](JobRange outer) {
        second.ParallelFor(20, 1, [&](JobRange inner) {
            sum += (outer.end - outer.begin) * (inner.end - inner.begin);
            first.ParallelFor(5, 1, [&](JobRange innermost) {
                if (innermost.worker >= first.WorkerCount()) ++strangers;
            });
        });
    });
    EXPECT_EQ(sum, 1000u);
    EXPECT_EQ(strangers, 0u);
}

TEST(ThreadPool, ServesCallersOnSeveralThreads) {
    ThreadPool pool(2);
    std::vector<std::thread> callers;
    for (int i = 0; i < 3; ++i)
        callers.emplace_back([&] {
            for (uint32_t n = 0; n < 300; ++n) {
                std::atomic<uint32_t> sum{0};
                pool.ParallelFor(n, 1, [&](JobRange range) { sum += range.end - range.begin; });
                EXPECT_EQ(sum, n);
            }
        });
    for (std::thread& caller : callers) caller.join();
}

TEST(ThreadPool, RunsAJobOnceOnEachWorkerThatIsFree) {
    ThreadPool pool(4);
    for (int i = 0; i < 2000; ++i) {
        std::atomic<uint32_t> times[4] = {};
        const auto caller = std::this_thread::get_id();
        std::atomic<bool> callerRan{false};
        pool.RunOnWorkers([&](uint32_t worker) {
            ++times[worker];
            if (std::this_thread::get_id() == caller) callerRan = true;
        });
        EXPECT_TRUE(callerRan);
        for (const auto& t : times) EXPECT_LE(t, 1u);
    }
}

TEST(ThreadPool, WakesHelpersThatWentToSleep) {
    ThreadPool pool(2);
    for (int i = 0; i < 5; ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));  // far beyond the time they spin
        std::atomic<uint32_t> arrived{0};
        pool.ParallelFor(2, 1, [&](JobRange) {
            ++arrived;
            while (arrived < 2) std::this_thread::yield();
        });
        EXPECT_EQ(arrived, 2u);
    }
}

TEST(ThreadPool, WhatAJobThrowsComesOut) {
    for (const uint32_t workers : {1u, 4u}) {
        ThreadPool pool(workers);
        for (uint32_t item = 0; item < 100; item += 7) {
            const auto job = [&](JobRange range) {
                if (range.begin <= item && item < range.end) throw item;
            };
            EXPECT_THROW(pool.ParallelFor(100, 1, job), uint32_t);
        }
        EXPECT_THROW(pool.RunOnWorkers([](uint32_t worker) { throw worker; }), uint32_t);
        // The helpers are there for the next job.
        std::atomic<uint32_t> ran{0};
        pool.ParallelFor(1000, 1, [&](JobRange range) { ran += range.end - range.begin; });
        EXPECT_EQ(ran, 1000u);
    }
}

}  // namespace
}  // namespace fulcrum
