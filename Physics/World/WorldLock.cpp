// The lock is one word, and every transition of it one atomic operation. It counts the threads inside and those that
// wait. A reader that finds a writer, inside or waiting, registers as waiting. The writer that leaves, or the step that
// lets queries in, turns all who wait into threads inside, and flips the bit on which they wait: so each reader waits
// for one writer at most, and each writer for the readers that came before it. The bit cannot flip twice before a
// waiting thread sees it, since no writer enters while that thread counts as inside.
//
// Queries and other readers are counted together once they are inside: beside a writer there are only queries.
#include <Fulcrum/Physics/World/WorldLock.h>

#include <Fulcrum/Jobs/FirstException.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <atomic>
#include <exception>
#include <thread>

namespace fulcrum {

namespace {

// The innermost of this thread's scopes.
thread_local WorldLock::Scope* tInnermost = nullptr;

// Fields of the word: numbers of threads, and bits. A number has 15 bits: with its usual limits Linux gives a process
// 32,765 threads (65,530 mappings, two for each stack). Whoever comes when a number is full waits outside.
constexpr uint64_t kMostThreads = (1u << 15) - 1;
struct Field {
    int shift;
    constexpr uint64_t One() const { return uint64_t{1} << shift; }
    constexpr uint64_t Mask() const { return kMostThreads << shift; }
    uint64_t Of(uint64_t word) const { return word >> shift & kMostThreads; }
};
constexpr Field kInside{0}, kWaitingQueries{15}, kWaitingReaders{30}, kWaitingWriters{45};
constexpr uint64_t kWriter = uint64_t{1} << 60;  // inside
constexpr uint64_t kOpen = uint64_t{1} << 61;    // ... and lets queries in
constexpr uint64_t kQueryTurn = uint64_t{1} << 62, kReaderTurn = uint64_t{1} << 63;

// Whether one more reader would be too many once all of them are inside. Quick where each number is below a quarter.
bool IsFull(uint64_t word) {
    constexpr uint64_t kQuarter = (kMostThreads + 1) / 4, kFourth = kMostThreads & ~(kQuarter - 1);
    constexpr uint64_t kMany =
        kFourth << kInside.shift | kFourth << kWaitingQueries.shift | kFourth << kWaitingReaders.shift;
    return (word & kMany) != 0 &&
           kInside.Of(word) + kWaitingQueries.Of(word) + kWaitingReaders.Of(word) >= kMostThreads;
}

uint64_t Admitted(uint64_t word, Field waiting, uint64_t turn) {
    const uint64_t count = waiting.Of(word);
    return (word - count * waiting.One() + count * kInside.One()) ^ turn;
}
uint64_t AdmitQueries(uint64_t word) { return Admitted(word, kWaitingQueries, kQueryTurn); }
uint64_t AdmitReaders(uint64_t word) { return Admitted(word, kWaitingReaders, kReaderTurn); }

}  // namespace

struct WorldLock::State {
    FULCRUM_WORLD_MEMORY

    std::atomic<uint64_t> word{0};

    // Replaces the word by change(word); returns the new one.
    template <class Change>
    uint64_t Replace(const Change& change) {
        uint64_t now = word.load(std::memory_order_relaxed), next;
        do next = change(now);
        while (!word.compare_exchange_weak(now, next, std::memory_order_acq_rel, std::memory_order_relaxed));
        return next;
    }
    // Waits until done(word).
    template <class Done>
    void WaitUntil(uint64_t now, const Done& done) {
        while (!done(now)) {
            word.wait(now, std::memory_order_acquire);
            now = word.load(std::memory_order_acquire);
        }
    }

    // Yields while there is no room for another thread.
    template <class Full>
    uint64_t AwaitRoom(const Full& isFull) {
        uint64_t now = word.load(std::memory_order_relaxed);
        for (; isFull(now); now = word.load(std::memory_order_relaxed)) std::this_thread::yield();
        return now;
    }

    void EnterAsReader(bool queries) {
        const uint64_t waiting = (queries ? kWaitingQueries : kWaitingReaders).One(),
                       turn = queries ? kQueryTurn : kReaderTurn;
        bool enters = false;
        uint64_t now, next;
        do {
            now = AwaitRoom(IsFull);
            enters = (queries && (now & kOpen)) || (now & (kWriter | kWaitingWriters.Mask())) == 0;
            next = now + (enters ? kInside.One() : waiting);
        } while (!word.compare_exchange_weak(now, next, std::memory_order_acq_rel, std::memory_order_relaxed));
        if (!enters) WaitUntil(next, [&](uint64_t then) { return ((then ^ next) & turn) != 0; });
    }
    void LeaveAsReader() {
        const uint64_t left = word.fetch_sub(kInside.One(), std::memory_order_acq_rel) - kInside.One();
        if (kInside.Of(left) == 0 && (left & (kWriter | kWaitingWriters.Mask())) != 0) word.notify_all();
    }
    void EnterAsWriter() {
        uint64_t now = word.load(std::memory_order_relaxed);
        if ((now & ~(kQueryTurn | kReaderTurn)) == 0 &&
            word.compare_exchange_strong(now, now | kWriter, std::memory_order_acquire, std::memory_order_relaxed))
            return;
        const auto isFull = [](uint64_t w) { return kWaitingWriters.Of(w) == kMostThreads; };
        do {
            now = AwaitRoom(isFull);
        } while (!word.compare_exchange_weak(now, now + kWaitingWriters.One(), std::memory_order_relaxed));
        for (;;) {
            WaitUntil(word.load(std::memory_order_acquire),
                      [](uint64_t w) { return (w & (kWriter | kInside.Mask())) == 0; });
            now = word.load(std::memory_order_relaxed);
            if ((now & (kWriter | kInside.Mask())) == 0 &&
                word.compare_exchange_weak(now, (now - kWaitingWriters.One()) | kWriter, std::memory_order_acquire,
                                           std::memory_order_relaxed))
                return;
        }
    }
    // Queries are no longer let in: where an exception ends a step, Break() has waited for those inside.
    void LeaveAsWriter() {
        Replace([](uint64_t now) { return AdmitReaders(AdmitQueries(now & ~(kWriter | kOpen))); });
        word.notify_all();
    }
    void Open() {
        Replace([](uint64_t now) { return AdmitQueries(now | kOpen); });
        word.notify_all();
    }
    void Close() {
        WaitUntil(Replace([](uint64_t now) { return now & ~kOpen; }),
                  [](uint64_t now) { return kInside.Of(now) == 0; });
    }
};

WorldLock::WorldLock(MemoryResource* memory) : state_(std::make_unique<State>()), memory_(memory) {}
WorldLock::~WorldLock() = default;

WorldLock::Access WorldLock::OfThisThread(const WorldLock& lock) {
    for (const Scope* scope = tInnermost; scope; scope = scope->outer_)
        if (&scope->lock_ == &lock) return scope->access_;
    return Access::None;
}

namespace {

std::optional<Error> RefusalOfReading(WorldLock::Access now, WorldLock::Access access) {
    if (now == WorldLock::Access::Changes)
        return Error{ErrorCode::NotAllowedHere,
                     "queries are not allowed in what a step or a change of the world calls back (contact listeners, "
                     "group filters, shapes and joints of one's own); ask before or after it"};
    if (now == WorldLock::Access::Queries && access == WorldLock::Access::Reads)
        return Error{ErrorCode::NotAllowedHere,
                     "what a query calls back may read all of the world only if the thread holds it still "
                     "(Queries().Hold()) before the query"};
    return std::nullopt;
}

std::optional<Error> RefusalOfChanging(WorldLock::Access now) {
    switch (now) {
        case WorldLock::Access::None:
        case WorldLock::Access::Edits: break;
        case WorldLock::Access::Queries:
        case WorldLock::Access::Reads:
            return Error{ErrorCode::NotAllowedHere,
                         "the world must not be changed nor stepped by a thread that holds it still "
                         "(Queries().Hold()), nor in what a "
                         "query calls back; do it when that is over"};
        case WorldLock::Access::Changes:
            return Error{
                ErrorCode::NotAllowedHere,
                "the world must not be changed nor stepped in what a step or a change of it calls back (contact "
                "listeners, "
                "group filters, shapes and joints of one's own); note what is to be done, and do it after the step"};
    }
    return std::nullopt;
}

// Within access of its own the thread keeps what it has, but for edits: callbacks of a query must not make any.
WorldLock::Access NestedReads(WorldLock::Access before, WorldLock::Access access) {
    if (before == WorldLock::Access::None) return access;
    return before == WorldLock::Access::Edits ? WorldLock::Access::Reads : before;
}
WorldLock::Access NestedChanges(WorldLock::Access before, WorldLock::Access access) {
    const bool isAllowed = before == WorldLock::Access::None || before == WorldLock::Access::Edits;
    return isAllowed ? access : before;
}

}  // namespace

std::optional<Error> WorldLock::RefusalOfReading(const WorldLock& lock, Access access) {
    return fulcrum::RefusalOfReading(OfThisThread(lock), access);
}
std::optional<Error> WorldLock::RefusalOfChanging(const WorldLock& lock) {
    return fulcrum::RefusalOfChanging(OfThisThread(lock));
}

std::optional<Error> WorldLock::RefusalOfBroken() const {
    if (!IsBroken()) [[likely]]
        return std::nullopt;
    return Error{
        ErrorCode::BrokenWorld,
        "an earlier step or call was cut short by an exception, as when memory ran out, and has left the world "
        "in between; restore it from a snapshot, or destroy it"};
}

void WorldLock::Mend() { __atomic_store_n(&isBroken_, false, __ATOMIC_RELAXED); }

// A step may be cut short while it lets queries in.
void WorldLock::Break() {
    __atomic_store_n(&isBroken_, true, __ATOMIC_RELAXED);
    if (LetsQueriesIn()) state_->Close();
}

WorldLock::Scope::Scope(WorldLock& lock, Access access)
    : lock_(lock), outer_(tInnermost), memoryBefore_(tCurrentMemory), access_(access) {
    tInnermost = this;
    tCurrentMemory = lock.memory_;
}

WorldLock::Scope::~Scope() {
    if (tInnermost == this) [[likely]] {
        tInnermost = outer_;
        tCurrentMemory = memoryBefore_;
        if (taken_ != Access::None) lock_.Leave(taken_);
    } else {
        EndBeforeInner();
    }
}

// What this scope would have restored is left to the one within, and the lock, if this one took it, to the outermost of
// those within that have the same.
void WorldLock::Scope::EndBeforeInner() {
    Scope* heir = nullptr;
    Scope* inner = tInnermost;
    for (; inner; inner = inner->outer_) {
        if (&inner->lock_ == &lock_) heir = inner;
        if (inner->outer_ == this) break;
    }
    if (!inner) AbortWith("Queries().Hold() and HoldForChanges() must end on the thread that began them", "");
    inner->outer_ = outer_;
    inner->memoryBefore_ = memoryBefore_;
    if (taken_ == Access::None) return;
    if (heir) heir->taken_ = taken_;
    else lock_.Leave(taken_);
}

WorldLock::Shared::Shared(WorldLock& lock, Access access) : Shared(lock, access, OfThisThread(lock)) {
    if (!refusal_) refusal_ = lock.RefusalOfBroken();
}
WorldLock::Shared::Shared(WorldLock& lock, Access access, Access before)
    : Scope(lock, NestedReads(before, access)), refusal_(fulcrum::RefusalOfReading(before, access)) {
    if (before != Access::None) return;
    taken_ = access;
    lock_.state_->EnterAsReader(access == Access::Queries);
}

WorldLock::Exclusive::Exclusive(WorldLock& lock, Access access) : Exclusive(lock, access, OfThisThread(lock)) {
    if (!refusal_) refusal_ = lock.RefusalOfBroken();
}
WorldLock::Exclusive::Exclusive(WorldLock& lock, Access access, Access before)
    : Scope(lock, NestedChanges(before, access)), refusal_(fulcrum::RefusalOfChanging(before)) {
    if (before != Access::None) return;
    taken_ = access;
    lock_.state_->EnterAsWriter();
}

void WorldLock::Exclusive::Begin() const { exceptions_ = std::uncaught_exceptions(); }

// The lock is given back by the scope.
WorldLock::Exclusive::~Exclusive() {
    if (exceptions_ >= 0 && std::uncaught_exceptions() > exceptions_) lock_.Break();
}

void WorldLock::Leave(Access taken) {
    if (taken == Access::Queries || taken == Access::Reads) state_->LeaveAsReader();
    else state_->LeaveAsWriter();
}

bool WorldLock::IsStepsOwn() const {
    for (const Scope* scope = tInnermost; scope; scope = scope->outer_)
        if (&scope->lock_ == this && scope->access_ == Access::Edits) return false;
    return true;
}

void WorldLock::LetQueriesIn() {
    if (IsStepsOwn()) state_->Open();
}

void WorldLock::KeepQueriesOut() {
    if (IsStepsOwn()) state_->Close();
}

bool WorldLock::LetsQueriesIn() const { return (state_->word.load(std::memory_order_relaxed) & kOpen) != 0; }

void WorldJobs::ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) {
    const WorldLock::Access access = WorldLock::OfThisThread(lock_);
    if (!jobs_ || (access == WorldLock::Access::Queries && lock_.LetsQueriesIn())) {
        if (count > 0) job({0, count, 0});
        return;
    }
    FirstException thrown;
    jobs_->ParallelFor(count, minimumRange, [&](JobRange range) {
        const WorldLock::Scope scope(lock_, access);
        const DefaultFloats floats;
        if (!thrown.HasAny()) thrown.Run([&] { job(range); });
    });
    thrown.Rethrow();
}

void WorldJobs::RunOnWorkers(FunctionRef<void(uint32_t worker)> job) {
    if (!jobs_) return job(0);
    const WorldLock::Access access = WorldLock::OfThisThread(lock_);
    FirstException thrown;
    jobs_->RunOnWorkers([&](uint32_t worker) {
        const WorldLock::Scope scope(lock_, access);
        const DefaultFloats floats;
        thrown.Run([&] { job(worker); });
    });
    thrown.Rethrow();
}

}  // namespace fulcrum
