// Runs the engine's loops on oneTBB, for games that use it, so that both share its threads. Any thread may call it,
// also from within a job.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <array>
#include <atomic>

namespace fulcrum::samples {

// The worker number is the slot of the thread in the arena. A thread that waits in the arena must not begin another
// range of the engine meanwhile, which would have the same worker number: hence `isolate`.
class TbbJobs final : public JobSystem {
public:
    static constexpr uint32_t kMostWorkers = 64;

    // threads: the caller included, 1 .. kMostWorkers; other values are clamped.
    explicit TbbJobs(uint32_t threads)
        : workers_(std::clamp(threads, 1u, kMostWorkers)), arena_(static_cast<int>(workers_)) {}

    uint32_t WorkerCount() const override { return workers_; }

    void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) override {
        if (count == 0) return;
        // Own ranges: those of TBB's partitioners may be half as long as requested.
        constexpr uint32_t kRangesPerWorker = 4;
        const uint32_t even = (count - 1) / (workers_ * kRangesPerWorker) + 1;
        const uint32_t size = std::max({minimumRange, even, 1u}), ranges = (count - 1) / size + 1;
        arena_.execute([&] {
            const auto run = [&](uint32_t i) {
                const uint32_t begin = i * size;
                job({begin, begin + std::min(size, count - begin), Worker()});
            };
            if (ranges == 1) return run(0);
            tbb::this_task_arena::isolate([&] { tbb::parallel_for(0u, ranges, run, tbb::simple_partitioner()); });
        });
    }

    void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) override {
        arena_.execute([&] {
            std::array<std::atomic<bool>, kMostWorkers> hasRun{};
            const auto run = [&] {
                const uint32_t worker = Worker();
                if (!hasRun[worker].exchange(true)) job(worker);
            };
            tbb::this_task_arena::isolate([&] {
                tbb::task_group others;
                for (uint32_t i = 1; i < workers_; ++i) others.run(run);
                run();
                others.wait();  // workers that have not begun return at once
            });
        });
    }

private:
    static uint32_t Worker() { return static_cast<uint32_t>(tbb::this_task_arena::current_thread_index()); }

    uint32_t workers_;
    tbb::task_arena arena_;
};

}  // namespace fulcrum::samples
