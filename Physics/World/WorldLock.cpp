// The lock is one word, and every transition of it one atomic operation. It counts the threads inside and those that
// wait. A reader that finds a writer, inside or waiting, registers as waiting. The writer that leaves, or the step that
// lets queries in, turns all who wait into threads inside, and flips the bit on which they wait: so each reader waits
// for one writer at most, and each writer for the readers that came before it. The bit cannot flip twice before a
// waiting thread sees it, since no writer enters while that thread counts as inside.
#include <Fulcrum/Physics/World/WorldLock.h>

#include <Fulcrum/Jobs/FirstException.h>
#include <Fulcrum/Math/Assert.h>

#include <atomic>
#include <exception>

namespace fulcrum {

namespace {

// The innermost of this thread's scopes.
thread_local WorldLock::Scope* tInnermost = nullptr;

// Fields of the word: numbers of threads, and bits.
struct Field {
    int shift;
    uint64_t One() const { return uint64_t{1} << shift; }
    uint64_t Mask() const { return uint64_t{1023} << shift; }
    uint64_t Of(uint64_t word) const { return word >> shift & 1023; }
};
constexpr Field kQueries{0}, kReaders{10}, kWaitingQueries{20}, kWaitingReaders{30}, kWaitingWriters{40};
constexpr uint64_t kWriter = uint64_t{1} << 50;  // inside
constexpr uint64_t kOpen = uint64_t{1} << 51;    // ... and lets queries in
constexpr uint64_t kQueryTurn = uint64_t{1} << 52, kReaderTurn = uint64_t{1} << 53;

uint64_t Admitted(uint64_t word, Field waiting, Field inside, uint64_t turn) {
    const uint64_t count = waiting.Of(word);
    return (word - count * waiting.One() + count * inside.One()) ^ turn;
}
uint64_t AdmitQueries(uint64_t word) { return Admitted(word, kWaitingQueries, kQueries, kQueryTurn); }
uint64_t AdmitReaders(uint64_t word) { return Admitted(word, kWaitingReaders, kReaders, kReaderTurn); }

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

    void EnterAsReader(bool queries) {
        const uint64_t inside = (queries ? kQueries : kReaders).One(),
                       waiting = (queries ? kWaitingQueries : kWaitingReaders).One(),
                       turn = queries ? kQueryTurn : kReaderTurn;
        bool enters = false;
        const uint64_t next = Replace([&](uint64_t now) {
            enters = (queries && (now & kOpen)) || (now & (kWriter | kWaitingWriters.Mask())) == 0;
            return now + (enters ? inside : waiting);
        });
        if (!enters) WaitUntil(next, [&](uint64_t now) { return ((now ^ next) & turn) != 0; });
    }
    void LeaveAsReader(bool queries) {
        const Field inside = queries ? kQueries : kReaders;
        const uint64_t left = word.fetch_sub(inside.One(), std::memory_order_acq_rel) - inside.One();
        if (inside.Of(left) == 0 && (left & (kWriter | kWaitingWriters.Mask())) != 0) word.notify_all();
    }
    void EnterAsWriter() {
        uint64_t now = word.fetch_add(kWaitingWriters.One(), std::memory_order_relaxed) + kWaitingWriters.One();
        for (;;) {
            WaitUntil(now, [](uint64_t w) { return (w & (kWriter | kReaders.Mask() | kQueries.Mask())) == 0; });
            now = word.load(std::memory_order_relaxed);
            if ((now & (kWriter | kReaders.Mask() | kQueries.Mask())) == 0 &&
                word.compare_exchange_weak(now, (now - kWaitingWriters.One()) | kWriter, std::memory_order_acquire,
                                           std::memory_order_relaxed))
                return;
        }
    }
    void LeaveAsWriter() {
        Replace([](uint64_t now) { return AdmitReaders(AdmitQueries(now & ~kWriter)); });
        word.notify_all();
    }
    void Open() {
        Replace([](uint64_t now) { return AdmitQueries(now | kOpen); });
        word.notify_all();
    }
    void Close() {
        WaitUntil(Replace([](uint64_t now) { return now & ~kOpen; }),
                  [](uint64_t now) { return kQueries.Of(now) == 0; });
    }
};

WorldLock::WorldLock(MemoryResource* memory) : state_(std::make_unique<State>()), memory_(memory) {}
WorldLock::~WorldLock() = default;

WorldLock::Access WorldLock::OfThisThread(const WorldLock& lock) {
    for (const Scope* scope = tInnermost; scope; scope = scope->outer_)
        if (&scope->lock_ == &lock) return scope->access_;
    return Access::None;
}

std::optional<Error> WorldLock::RefusalOfReading(const WorldLock& lock, Access access) {
    const Access now = OfThisThread(lock);
    if (now == Access::Changes)
        return Error{ErrorCode::NotAllowedHere,
                     "queries are not allowed in what a step or a change of the world calls back (contact listeners, "
                     "group filters, shapes and joints of one's own); ask before or after it"};
    if (now == Access::Queries && access == Access::Reads)
        return Error{ErrorCode::NotAllowedHere,
                     "what a query calls back may read all of the world only if the thread holds it still "
                     "(Queries().Hold()) before the query"};
    return std::nullopt;
}

std::optional<Error> WorldLock::RefusalOfChanging(const WorldLock& lock) {
    switch (OfThisThread(lock)) {
        case Access::None:
        case Access::Edits: break;
        case Access::Queries:
        case Access::Reads:
            return Error{ErrorCode::NotAllowedHere,
                         "the world must not be changed nor stepped by a thread that holds it still "
                         "(Queries().Hold()), nor in what a "
                         "query calls back; do it when that is over"};
        case Access::Changes:
            return Error{
                ErrorCode::NotAllowedHere,
                "the world must not be changed nor stepped in what a step or a change of it calls back (contact "
                "listeners, "
                "group filters, shapes and joints of one's own); note what is to be done, and do it after the step"};
    }
    return std::nullopt;
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
    : MemoryScope(lock.memory_), lock_(lock), before_(OfThisThread(lock)), outer_(tInnermost), access_(access) {
    tInnermost = this;
}

WorldLock::Scope::~Scope() {
    FULCRUM_ASSERT(tInnermost == this);
    tInnermost = outer_;
}

namespace {

// Within access of its own the thread keeps what it has, but for edits: callbacks of a query must not make any.
WorldLock::Access NestedReads(WorldLock::Access before, WorldLock::Access access) {
    if (before == WorldLock::Access::None) return access;
    return before == WorldLock::Access::Edits ? WorldLock::Access::Reads : before;
}

}  // namespace

// Checks for refusal before the scope becomes this thread's innermost.
WorldLock::Shared::Shared(WorldLock& lock, Access access) : Shared(lock, access, RefusalOfReading(lock, access)) {
    if (!refusal_) refusal_ = lock.RefusalOfBroken();
}
WorldLock::Shared::Shared(WorldLock& lock, Access access, std::optional<Error> refusal)
    : Scope(lock, NestedReads(OfThisThread(lock), access)), refusal_(std::move(refusal)) {
    if (before_ != Access::None) return;
    taken_ = access;
    lock_.state_->EnterAsReader(access == Access::Queries);
}

WorldLock::Shared::~Shared() {
    if (taken_ != Access::None) lock_.state_->LeaveAsReader(taken_ == Access::Queries);
}

WorldLock::Exclusive::Exclusive(WorldLock& lock, Access access) : Exclusive(lock, access, RefusalOfChanging(lock)) {
    if (!refusal_) refusal_ = lock.RefusalOfBroken();
}
WorldLock::Exclusive::Exclusive(WorldLock& lock, Access access, std::optional<Error> refusal)
    : Scope(lock, refusal ? OfThisThread(lock) : access), refusal_(std::move(refusal)) {
    if (before_ == Access::None) lock_.state_->EnterAsWriter();
}

void WorldLock::Exclusive::Begin() const { exceptions_ = std::uncaught_exceptions(); }

WorldLock::Exclusive::~Exclusive() {
    if (exceptions_ >= 0 && std::uncaught_exceptions() > exceptions_) lock_.Break();
    if (before_ == Access::None) lock_.state_->LeaveAsWriter();
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
        thrown.Run([&] { job(worker); });
    });
    thrown.Rethrow();
}

}  // namespace fulcrum
