// The smallest job system: the calling thread does everything. For programs without threads, and for debugging; results
// are bit-identical to those with any number of threads.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>

namespace fulcrum::samples {

class SingleThreadJobs final : public JobSystem {
public:
    uint32_t WorkerCount() const override { return 1; }
    void ParallelFor(uint32_t count, uint32_t, FunctionRef<void(JobRange)> job) override {
        if (count > 0) job({0, count, 0});
    }
    void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) override { job(0); }
};

}  // namespace fulcrum::samples
