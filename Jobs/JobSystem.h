// The interface through which the engine uses threads, so that a game can plug in its own. ThreadPool is the engine's
// implementation.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstdint>
#include <type_traits>
#include <utility>

namespace fulcrum {

// A reference to a callable that outlives the call it is passed to. Allocates nothing.
template <class Signature>
class FunctionRef;
template <class R, class... Args>
class FunctionRef<R(Args...)> {
public:
    template <class F>
    requires(!std::is_same_v<std::remove_cvref_t<F>, FunctionRef>) FunctionRef(F&& f)
        : object_(const_cast<void*>(static_cast<const void*>(&f))), call_([](void* o, Args... args) -> R {
              return (*static_cast<std::remove_reference_t<F>*>(o))(std::forward<Args>(args)...);
          }) {}
    R operator()(Args... args) const { return call_(object_, std::forward<Args>(args)...); }

private:
    void* object_;
    R (*call_)(void*, Args...);
};

// A range of items and the worker that runs it. `worker` is 0..WorkerCount() - 1 and unique among the ranges that run
// at the same time: it selects scratch memory.
struct JobRange {
    uint32_t begin, end;
    uint32_t worker;
};

// The engine's jobs throw nothing: what happens in them is thrown where they are waited for.
class JobSystem {
public:
    virtual ~JobSystem() = default;

    // Threads that may run a job at the same time, the caller included. >= 1, constant.
    virtual uint32_t WorkerCount() const = 0;

    // Runs `job` over 0 .. count - 1 in ranges of at least `minimumRange` items (the last may be shorter) and returns
    // when all are done. The caller takes part. The partition must not influence the engine's results.
    virtual void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) = 0;

    // Runs `job(worker)` once on every free worker, and always on the caller; returns when all started runs have
    // returned. The engine only relies on the caller's run: further workers make it faster.
    virtual void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) = 0;
};

}  // namespace fulcrum
