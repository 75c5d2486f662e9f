#include <Fulcrum/Physics/World/WorldLock.h>

#include <Fulcrum/Math/Assert.h>

#include <algorithm>
#include <atomic>
#include <shared_mutex>

namespace fulcrum {

namespace {

// The innermost of this thread's scopes.
thread_local WorldLock::Scope* tInnermost = nullptr;

}  // namespace

struct WorldLock::State {
    std::shared_mutex mutex;
    std::atomic<uint32_t> writers{0};  // writers that wait or hold the lock
};

WorldLock::WorldLock() : state_(std::make_unique<State>()) {}
WorldLock::~WorldLock() = default;

WorldLock::Access WorldLock::OfThisThread(const WorldLock& lock) {
    Access most = Access::None;
    for (const Scope* scope = tInnermost; scope; scope = scope->outer_)
        if (&scope->lock_ == &lock) most = std::max(most, scope->access_);
    return most;
}

std::optional<Error> WorldLock::RefusalOfReading(const WorldLock& lock) {
    if (OfThisThread(lock) != Access::Changes) return std::nullopt;
    return Error{
        ErrorCode::NotAllowedHere,
        "queries are not allowed in what a step or a change of the world calls back (contact listeners, group filters, "
        "shapes and joints of one's own); ask before or after it"};
}

std::optional<Error> WorldLock::RefusalOfChanging(const WorldLock& lock) {
    switch (OfThisThread(lock)) {
        case Access::None: break;
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

WorldLock::Scope::Scope(WorldLock& lock, Access access)
    : lock_(lock), before_(OfThisThread(lock)), outer_(tInnermost), access_(access) {
    tInnermost = this;
}

WorldLock::Scope::~Scope() {
    FULCRUM_ASSERT(tInnermost == this);
    tInnermost = outer_;
}

// Checks for refusal before the scope becomes this thread's innermost.
WorldLock::Shared::Shared(WorldLock& lock) : Shared(lock, RefusalOfReading(lock)) {}
WorldLock::Shared::Shared(WorldLock& lock, std::optional<Error> refusal)
    : Scope(lock, Access::Reads), refusal_(std::move(refusal)) {
    if (before_ != Access::None) return;
    const uint32_t writers = lock_.state_->writers.load(std::memory_order_acquire);
    if (writers != 0) lock_.state_->writers.wait(writers, std::memory_order_acquire);
    lock_.state_->mutex.lock_shared();
}

WorldLock::Shared::~Shared() {
    if (before_ == Access::None) lock_.state_->mutex.unlock_shared();
}

WorldLock::Exclusive::Exclusive(WorldLock& lock) : Exclusive(lock, RefusalOfChanging(lock)) {}
WorldLock::Exclusive::Exclusive(WorldLock& lock, std::optional<Error> refusal)
    : Scope(lock, refusal ? Access::None : Access::Changes), refusal_(std::move(refusal)) {
    if (before_ != Access::None) return;
    lock_.state_->writers.fetch_add(1, std::memory_order_acq_rel);
    lock_.state_->mutex.lock();
}

WorldLock::Exclusive::~Exclusive() {
    if (before_ != Access::None) return;
    lock_.state_->mutex.unlock();
    lock_.state_->writers.fetch_sub(1, std::memory_order_acq_rel);
    lock_.state_->writers.notify_all();
}

void WorldJobs::ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) {
    const WorldLock::Access access = WorldLock::OfThisThread(lock_);
    jobs_.ParallelFor(count, minimumRange, [&](JobRange range) {
        const WorldLock::Scope scope(lock_, access);
        job(range);
    });
}

void WorldJobs::RunOnWorkers(FunctionRef<void(uint32_t worker)> job) {
    const WorldLock::Access access = WorldLock::OfThisThread(lock_);
    jobs_.RunOnWorkers([&](uint32_t worker) {
        const WorldLock::Scope scope(lock_, access);
        job(worker);
    });
}

}  // namespace fulcrum
