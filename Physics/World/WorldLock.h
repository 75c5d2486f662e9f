// Reader-writer lock: queries share the world, changes and steps have exclusive access. A reader that arrives while a
// writer waits lets it go first, once, so that neither starves. Access is recorded per thread: nested access of a kind
// that the thread already has takes no lock, and access that would deadlock is refused.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Math/Result.h>

#include <memory>
#include <optional>

namespace fulcrum {

class WorldLock {
public:
    WorldLock();
    ~WorldLock();

    enum class Access : uint8_t { None, Reads, Changes };
    // The highest access of this thread, its own or inherited from the thread whose job it runs.
    static Access OfThisThread(const WorldLock& lock);
    // Why this thread may not read or change the world now; empty if it may.
    static std::optional<Error> RefusalOfReading(const WorldLock& lock);
    static std::optional<Error> RefusalOfChanging(const WorldLock& lock);

    // Records this thread's access for the lifetime of the object, without taking the lock. Used directly by workers
    // that run jobs of a thread which holds the lock.
    class Scope {
    public:
        Scope(WorldLock& lock, Access access);
        ~Scope();
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

    protected:
        WorldLock& lock_;
        const Access before_;  // this thread's access outside the scope

    private:
        friend class WorldLock;
        Scope* outer_;
        Access access_;
    };

    class Shared : public Scope {
    public:
        explicit Shared(WorldLock& lock);
        ~Shared();
        // Empty unless this thread is changing or stepping the world: then the object does nothing.
        const std::optional<Error>& Refusal() const { return refusal_; }

    private:
        Shared(WorldLock& lock, std::optional<Error> refusal);
        std::optional<Error> refusal_;
    };

    class Exclusive : public Scope {
    public:
        explicit Exclusive(WorldLock& lock);
        ~Exclusive();
        // Empty unless this thread reads or changes the world already: then the object does nothing.
        const std::optional<Error>& Refusal() const { return refusal_; }

    private:
        Exclusive(WorldLock& lock, std::optional<Error> refusal);
        std::optional<Error> refusal_;
    };

private:
    struct State;  // so that <shared_mutex> and <atomic>, which are slow to compile, stay out of programs
    const std::unique_ptr<State> state_;
};

// A job system that gives workers the access of the thread whose job they run, while they run it.
class WorldJobs final : public JobSystem {
public:
    WorldJobs(JobSystem& jobs, WorldLock& lock) : jobs_(jobs), lock_(lock) {}
    uint32_t WorkerCount() const override { return jobs_.WorkerCount(); }
    void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) override;
    void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) override;

private:
    JobSystem& jobs_;
    WorldLock& lock_;
};

}  // namespace fulcrum
