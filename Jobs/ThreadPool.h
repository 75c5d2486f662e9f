// The engine's own job system: a work-stealing thread pool. Used by PhysicsSystem unless the game provides its own
// JobSystem. Any thread may call it, jobs included; constructed and destroyed by one thread while no call is running.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>

#include <memory>

namespace fulcrum {

// The calling thread is worker 0 and always does its share: no call waits for a helper thread that has not begun.
// Helpers spin for some 100 us after a job, which covers the gaps within a step, and then sleep.
//
// Only one call uses the helpers at a time. A call from inside a job runs on its own thread alone, under the worker
// that thread already has. So does a call from a second thread outside the pool, as worker 0 of its own call: ids are
// unique within a call, and memory they select must belong to that call.
//
// What a job throws is thrown by the call, once all workers are done; some ranges may not have been run then. Nothing
// is allocated after construction.
class ThreadPool final : public JobSystem {
public:
    static constexpr uint32_t kMaximumWorkers = 64;

    // workers: threads that take part, the caller included, so that 1 starts no thread. Clamped to 1 ..
    // kMaximumWorkers; fewer if the operating system refuses to start that many (see WorkerCount).
    explicit ThreadPool(uint32_t workers);
    ~ThreadPool() override;
    ThreadPool(const ThreadPool&) = delete;
    ThreadPool& operator=(const ThreadPool&) = delete;

    uint32_t WorkerCount() const override { return helperCount_ + 1; }

    // minimumRange 0 counts as 1. A count of at most minimumRange is one range on the caller and wakes nobody.
    void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) override;

    void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) override;

private:
    struct Blocks {
        uint32_t begin, end;
    };
    struct State;  // so that <thread> and <atomic>, which are slow to compile, stay out of programs

    bool TryTakeHelpers();
    void Dispatch(FunctionRef<void(uint32_t)> job) noexcept;
    void RunHelper(uint32_t worker);
    uint32_t CallersWorker() const;

    Blocks TakeFromOwnShare(uint32_t worker);
    Blocks Steal(uint32_t thief);

    const std::unique_ptr<State> state_;
    uint32_t helperCount_ = 0;
};

}  // namespace fulcrum
