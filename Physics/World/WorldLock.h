// Reader-writer lock with two kinds of readers. Whoever changes or steps the world has exclusive access. During most of
// a step, queries are let in: what they read, poses and trees, changes only in the first stage, when bodies are moved,
// and in the last ones, and is the state of the last step in between. Other readers wait for the whole step. A reader
// that arrives while a writer waits lets it go first, once, so that neither starves.
//
// Access is recorded per thread: nested access of a kind that the thread already has takes no lock, and access that
// would deadlock is refused. The world's memory is the current one of the thread meanwhile (Memory.h).
//
// A writer that is cut short by an exception after its Begin() leaves a broken world. Access to it is refused, but for
// the writer that restores it.
//
// Objects that hold the lock may end in any order: it is given back with the last of those within the one that took it.
// They end on the thread that made them; elsewhere the program is stopped.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Result.h>

#include <memory>
#include <optional>

namespace fulcrum {

class WorldLock {
public:
    explicit WorldLock(MemoryResource* memory = nullptr);
    ~WorldLock();

    enum class Access : uint8_t {
        None,
        Queries,  // may read what queries read
        Reads,    // may read everything
        Edits,    // keeps all other threads out, and may read and change
        Changes,  // is changing or stepping the world: neither reads nor further changes are allowed
    };
    // The access of this thread in its innermost scope, its own or that of the thread whose job it runs.
    static Access OfThisThread(const WorldLock& lock);
    // Why this thread may not read or change the world now; empty if it may.
    static std::optional<Error> RefusalOfReading(const WorldLock& lock, Access access = Access::Reads);
    static std::optional<Error> RefusalOfChanging(const WorldLock& lock);
    bool IsBroken() const { return __atomic_load_n(&isBroken_, __ATOMIC_RELAXED); }
    std::optional<Error> RefusalOfBroken() const;
    void Mend();  // by a writer that has restored the world

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
        Access taken_ = Access::None;  // of the lock, to be given back

    private:
        friend class WorldLock;
        void EndBeforeInner();
        Scope* outer_;
        MemoryResource* memoryBefore_;
        Access access_;
    };

    class Shared : public Scope {
    public:
        // access: Queries or Reads.
        explicit Shared(WorldLock& lock, Access access = Access::Reads);
        // Empty unless this thread is changing or stepping the world, or holds it for queries alone and asks for more:
        // then the object does nothing; or the world is broken.
        const std::optional<Error>& Refusal() const { return refusal_; }

    private:
        Shared(WorldLock& lock, Access access, Access before);
        std::optional<Error> refusal_;
    };

    class Exclusive : public Scope {
    public:
        // access: Changes, or Edits to change and read several times.
        explicit Exclusive(WorldLock& lock, Access access = Access::Changes);
        ~Exclusive();
        // Empty unless this thread reads or changes the world already: then the object does nothing; or the world is
        // broken.
        const std::optional<Error>& Refusal() const { return refusal_; }
        // From here on an exception leaves the world neither as it was nor as it should be.
        void Begin() const;

    private:
        Exclusive(WorldLock& lock, Access access, Access before);
        std::optional<Error> refusal_;
        mutable int exceptions_ = -1;  // in flight at Begin(); -1: it has not begun
    };

    // Called by a step: from now on what queries read does not change, until KeepQueriesOut returns. Nothing if this
    // thread holds the world by Edits, so that it keeps others out of the step, too.
    void LetQueriesIn();
    void KeepQueriesOut();
    // Whether queries are let in now.
    bool LetsQueriesIn() const;

private:
    struct State;  // so that <atomic>, which is slow to compile, stays out of programs
    bool IsStepsOwn() const;
    void Break();
    void Leave(Access taken);
    const std::unique_ptr<State> state_;
    MemoryResource* const memory_;
    bool isBroken_ = false;  // atomic
};

// A job system that gives workers the access of the thread whose job they run, while they run it. Jobs of queries
// during a step run on the calling thread alone: the step needs the workers. So do all if `jobs` is null. What jobs
// throw is thrown by the call, whatever the job system does with exceptions.
class WorldJobs final : public JobSystem {
public:
    FULCRUM_WORLD_MEMORY
    WorldJobs(JobSystem* jobs, WorldLock& lock) : jobs_(jobs), lock_(lock) {}
    uint32_t WorkerCount() const override { return jobs_ ? jobs_->WorkerCount() : 1; }
    void ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) override;
    void RunOnWorkers(FunctionRef<void(uint32_t worker)> job) override;

private:
    JobSystem* jobs_;
    WorldLock& lock_;
};

}  // namespace fulcrum
