// What a job threw that runs on several threads: no thread but the one that waits for all of them can hand it to the
// program, and a thread that left by it would keep the others waiting. Used by ThreadPool, RunPhases and WorldJobs.
#pragma once

#include <atomic>
#include <exception>

namespace fulcrum {

class FirstException {
public:
    // Whether a run has thrown: what is left of the job need not be done.
    bool HasAny() const { return isTaken_.load(std::memory_order_relaxed); }
    // Runs work() and keeps what it throws; by any thread.
    template <class Work>
    void Run(Work&& work) noexcept {
        try {
            work();
        } catch (...) {
            if (!isTaken_.exchange(true, std::memory_order_relaxed)) first_ = std::current_exception();
        }
    }
    // By the thread that has waited for all runs, and so sees what they wrote.
    void Rethrow() const {
        if (first_) std::rethrow_exception(first_);
    }

private:
    std::atomic<bool> isTaken_{false};
    std::exception_ptr first_;
};

}  // namespace fulcrum
