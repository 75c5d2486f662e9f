#include <Fulcrum/Physics/State/WorldLock.h>

#include <Fulcrum/Math/Assert.h>

namespace fulcrum {

namespace {
// The innermost of this thread's scopes.
thread_local WorldLock::Shared* tInnermost = nullptr;
}  // namespace

bool WorldLock::Shared::IsHeldByThisThread(const WorldLock& lock) {
    for (const Shared* scope = tInnermost; scope; scope = scope->outer_)
        if (&scope->lock_ == &lock) return true;
    return false;
}

WorldLock::Shared::Shared(WorldLock& lock, Kind kind)
    : lock_(lock), outer_(tInnermost), isHolder_(kind == Kind::Own && !IsHeldByThisThread(lock)) {
    if (isHolder_) {
        const uint32_t writers = lock_.writers_.load(std::memory_order_acquire);
        if (writers != 0) lock_.writers_.wait(writers, std::memory_order_acquire);
        lock_.mutex_.lock_shared();
    }
    tInnermost = this;
}

WorldLock::Shared::~Shared() {
    FULCRUM_ASSERT(tInnermost == this);
    tInnermost = outer_;
    if (isHolder_) lock_.mutex_.unlock_shared();
}

WorldLock::Exclusive::Exclusive(WorldLock& lock) : lock_(lock) {
    FULCRUM_ASSERT(!Shared::IsHeldByThisThread(lock));
    lock_.writers_.fetch_add(1, std::memory_order_acq_rel);
    lock_.mutex_.lock();
}

WorldLock::Exclusive::~Exclusive() {
    lock_.mutex_.unlock();
    lock_.writers_.fetch_sub(1, std::memory_order_acq_rel);
    lock_.writers_.notify_all();
}

}  // namespace fulcrum
