#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Jobs/ThreadPool.h>

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace fulcrum {
namespace {

// Minimal job systems, as a game could provide.
class SerialJobs final : public JobSystem {
public:
    explicit SerialJobs(uint32_t workers = 1) : workers_(workers) {}
    uint32_t WorkerCount() const override { return workers_; }
    void ParallelFor(uint32_t count, uint32_t, FunctionRef<void(JobRange)> job) override {
        if (count > 0) job({0, count, workers_ - 1});
    }
    void RunOnWorkers(FunctionRef<void(uint32_t)> job) override { job(workers_ - 1); }

private:
    uint32_t workers_;
};

class ThreadsPerCall final : public JobSystem {
public:
    explicit ThreadsPerCall(uint32_t workers) : workers_(workers) {}
    uint32_t WorkerCount() const override { return workers_; }
    void ParallelFor(uint32_t count, uint32_t, FunctionRef<void(JobRange)> job) override {
        if (count > 0) job({0, count, 0});
    }
    void RunOnWorkers(FunctionRef<void(uint32_t)> job) override {
        std::vector<std::thread> threads;
        for (uint32_t worker = 1; worker < workers_; ++worker) threads.emplace_back([=] { job(worker); });
        job(0);
        for (std::thread& thread : threads) thread.join();
    }

private:
    uint32_t workers_;
};

uint64_t Mix(uint64_t a, uint64_t b) { return (a ^ (b + 0x9e3779b97f4a7c15u + (a << 6) + (a >> 2))) * 0x100000001b3u; }

// Each block mixes what the phase before left in two blocks of another array, so that a block that runs early, twice or
// never changes the result, and the thread sanitizer sees the missing order. The reference is the plain double loop.
struct Relay {
    explicit Relay(std::span<const uint32_t> counts) : counts_(counts) {
        uint32_t largest = 1;
        for (const uint32_t count : counts) largest = std::max(largest, count);
        for (auto& values : values_) {
            values.resize(largest);
            for (uint32_t i = 0; i < largest; ++i) values[i] = i;
        }
    }
    void Run(uint32_t phase, uint32_t block) {
        const std::vector<uint64_t>& from = values_[phase % 2];
        std::vector<uint64_t>& to = values_[(phase + 1) % 2];
        const uint64_t neighbor = from[(block * 7 + phase) % from.size()];
        to[block] = Mix(Mix(to[block], from[block]), neighbor);
    }
    std::span<const uint32_t> counts_;
    std::vector<uint64_t> values_[2];
};

void ExpectPhasesInOrder(JobSystem& jobs, std::span<const uint32_t> counts) {
    Relay expected(counts), actual(counts);
    for (uint32_t phase = 0; phase < counts.size(); ++phase)
        for (uint32_t block = 0; block < counts[phase]; ++block) expected.Run(phase, block);

    std::vector<std::atomic<uint32_t>> finished(counts.size());
    std::vector<std::atomic<bool>> workerIsBusy(jobs.WorkerCount());
    std::atomic<uint32_t> early{0}, clashes{0};
    RunPhases(jobs, counts, [&](uint32_t phase, uint32_t block, uint32_t worker) {
        if (workerIsBusy[worker].exchange(true)) ++clashes;
        if (phase > 0 && finished[phase - 1].load(std::memory_order_relaxed) != counts[phase - 1]) ++early;
        actual.Run(phase, block);
        finished[phase].fetch_add(1, std::memory_order_relaxed);
        workerIsBusy[worker].store(false);
    });
    ASSERT_EQ(early, 0u);
    ASSERT_EQ(clashes, 0u);
    for (size_t phase = 0; phase < counts.size(); ++phase)
        ASSERT_EQ(finished[phase], counts[phase]) << "phase " << phase;
    ASSERT_EQ(actual.values_[0], expected.values_[0]);
    ASSERT_EQ(actual.values_[1], expected.values_[1]);
}

// Deterministic counts with all the cases in a row: none, lone blocks one after another, a few, many.
std::vector<uint32_t> VariedCounts(uint32_t phases, uint32_t seed) {
    std::vector<uint32_t> counts(phases);
    uint32_t state = seed * 2654435761u + 1;
    for (uint32_t& count : counts) {
        state = state * 1664525u + 1013904223u;
        const uint32_t draw = state >> 16;
        count = draw % 8 == 0 ? 0 : draw % 8 < 4 ? 1 : draw % 8 < 7 ? draw % 5 : draw % 60;
    }
    return counts;
}

TEST(Phases, RunInOrderOnAnyNumberOfWorkers) {
    for (const uint32_t workers : {1u, 2u, 3u, 4u}) {
        ThreadPool pool(workers);
        for (uint32_t seed = 0; seed < 30; ++seed) ExpectPhasesInOrder(pool, VariedCounts(100, seed));
    }
}

TEST(Phases, RunInOrderTenThousandTimes) {
    for (const uint32_t workers : {1u, 2u, 3u, 4u}) {
        ThreadPool pool(workers);
        for (uint32_t seed = 0; seed < 2500; ++seed) ExpectPhasesInOrder(pool, VariedCounts(12, seed));
    }
}

TEST(Phases, WithoutPhasesOrBlocksDoNothing) {
    ThreadPool pool(2);
    ExpectPhasesInOrder(pool, {});
    ExpectPhasesInOrder(pool, std::vector<uint32_t>{0, 0, 0});
    ExpectPhasesInOrder(pool, std::vector<uint32_t>{0, 5, 0, 0, 3, 1, 0});
}

TEST(Phases, OfOneBlockEachFollowOneAnother) {
    ThreadPool pool(2);
    ExpectPhasesInOrder(pool, std::vector<uint32_t>(200, 1));
    std::vector<uint32_t> alternating(200, 1);
    for (size_t i = 0; i < alternating.size(); i += 3) alternating[i] = 2;
    for (int i = 0; i < 100; ++i) ExpectPhasesInOrder(pool, alternating);
}

TEST(Phases, NeedNoHelper) {
    SerialJobs one, fourOfWhichOneComes(4);
    for (uint32_t seed = 0; seed < 20; ++seed) {
        ExpectPhasesInOrder(one, VariedCounts(50, seed));
        ExpectPhasesInOrder(fourOfWhichOneComes, VariedCounts(50, seed));
    }
}

TEST(Phases, RunOnAForeignJobSystem) {
    for (const uint32_t workers : {2u, 3u, 70u}) {
        ThreadsPerCall jobs(workers);
        for (uint32_t seed = 0; seed < 10; ++seed) ExpectPhasesInOrder(jobs, VariedCounts(30, seed));
    }
}

TEST(Phases, FinishWithMoreWorkersThanCores) {
    ThreadPool pool(12);
    for (uint32_t seed = 0; seed < 5; ++seed) ExpectPhasesInOrder(pool, VariedCounts(30, seed));
}

TEST(Phases, OfVeryManyBlocksAreRunToo) {
    ThreadPool pool(2);
    for (const uint32_t count : {(1u << 20) - 1, 1u << 20, (1u << 20) + 1}) {
        std::atomic<uint32_t> ran{0};
        RunPhases(pool, std::vector<uint32_t>{2, count},
                  [&](uint32_t, uint32_t, uint32_t) { ran.fetch_add(1, std::memory_order_relaxed); });
        EXPECT_EQ(ran, count + 2);
    }
}

TEST(Phases, RunInsideAJobUnderItsWorker) {
    ThreadPool pool(3);
    std::atomic<uint32_t> strangers{0}, ran{0};
    pool.ParallelFor(30, 1, [&](JobRange outer) {
        for (const auto& counts : {std::vector<uint32_t>{3, 1, 2}, std::vector<uint32_t>{1, 1}})
            RunPhases(pool, counts, [&](uint32_t, uint32_t, uint32_t worker) {
                if (worker != outer.worker) ++strangers;
                ran += outer.end - outer.begin;
            });
    });
    EXPECT_EQ(ran, 30u * 8u);
    EXPECT_EQ(strangers, 0u);
}

TEST(Phases, KernelsMayUseTheJobSystem) {
    ThreadPool pool(2);
    std::atomic<uint32_t> items{0};
    RunPhases(pool, std::vector<uint32_t>{4, 1, 4}, [&](uint32_t, uint32_t, uint32_t) {
        pool.ParallelFor(10, 1, [&](JobRange range) { items += range.end - range.begin; });
    });
    EXPECT_EQ(items, 90u);
}

TEST(Phases, ShareTheirBlocksOut) {
    ThreadPool pool(2);
    std::atomic<uint32_t> arrived{0};
    // Each of two blocks waits for the other, in each of ten phases.
    RunPhases(pool, std::vector<uint32_t>(10, 2), [&](uint32_t phase, uint32_t, uint32_t) {
        ++arrived;
        while (arrived < 2 * (phase + 1)) std::this_thread::yield();
    });
    EXPECT_EQ(arrived, 20u);
}

// Whichever block throws, and on whichever worker: nobody waits for the blocks that are not run, and the pool goes on.
TEST(Phases, WhatAKernelThrowsComesOut) {
    ThreadPool pool(4);
    SerialJobs serial(4);
    const std::vector<uint32_t> counts = {7, 1, 1, 30, 3, 1};
    for (JobSystem* const jobs : {static_cast<JobSystem*>(&pool), static_cast<JobSystem*>(&serial)}) {
        for (uint32_t phase = 0; phase < counts.size(); ++phase) {
            for (uint32_t block = 0; block < counts[phase]; block += 3) {
                std::atomic<uint32_t> later{0};
                const auto kernel = [&](uint32_t p, uint32_t b, uint32_t) {
                    if (p > phase) ++later;
                    if (p == phase && b == block) throw block;
                };
                try {
                    RunPhases(*jobs, counts, kernel);
                    ADD_FAILURE();
                } catch (const uint32_t thrown) {
                    EXPECT_EQ(thrown, block);
                }
                EXPECT_EQ(later, 0u);
            }
        }
    }
    std::atomic<uint32_t> ran{0};
    RunPhases(pool, counts, [&](uint32_t, uint32_t, uint32_t) { ++ran; });
    EXPECT_EQ(ran, 43u);
}

}  // namespace
}  // namespace fulcrum
