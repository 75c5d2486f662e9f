// The gate: one word that says whether there is a job to join and how many helpers are in it:
//
//     generation (22 bits) | stop (1) | open (1) | helpers inside (8)
//
// The caller writes `job` while the gate is shut and empty, opens it under a new generation, does its own share, shuts
// it, and waits until it is empty. A helper enters by a compare-and-swap that increments the count, which succeeds only
// while the gate is open: a late helper finds it shut and never touches the job, which lives on the caller's stack.
// Each helper enters a generation once.
//
// The opening store releases `job` and the caller's earlier writes, and the helper's entry acquires them; the helper's
// exit releases its writes, and the caller acquires them where it shuts the gate or waits. Further entries and exits
// are read-modify-writes, so they keep the release sequence.
#include <Fulcrum/Jobs/FirstException.h>
#include <Fulcrum/Jobs/Spin.h>
#include <Fulcrum/Jobs/ThreadPool.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

namespace fulcrum {
namespace {

constexpr uint32_t kInsideMask = 0xff;
constexpr uint32_t kOpen = 0x100;
constexpr uint32_t kStop = 0x200;
constexpr uint32_t kGeneration = 0x400;
// A helper without a job: longer than a serial stage of a small step.
constexpr std::chrono::microseconds kIdleSpin{100};
// The caller, for helpers that are still inside.
constexpr std::chrono::microseconds kFinishSpin{50};

uint32_t GenerationOf(uint32_t gate) { return gate / kGeneration; }

// The worker numbers of this thread, innermost job first: a job of one pool may use another pool.
struct Membership {
    const ThreadPool* pool;
    uint32_t worker;
    const Membership* outer;
};
thread_local const Membership* innermost = nullptr;

const Membership* FindMembership(const ThreadPool* pool) {
    const Membership* m = innermost;
    while (m && m->pool != pool) m = m->outer;
    return m;
}

uint64_t Pack(uint32_t begin, uint32_t end) { return uint64_t{begin} << 32 | end; }
uint32_t BeginOf(uint64_t blocks) { return static_cast<uint32_t>(blocks >> 32); }
uint32_t EndOf(uint64_t blocks) { return static_cast<uint32_t>(blocks); }

// Takes an eighth of the remaining blocks at a time: few atomic operations at first, small pieces near the end for load
// balance. At least one block.
uint32_t PieceOf(uint32_t blocksLeft) { return (blocksLeft + 7) / 8; }

}  // namespace

struct ThreadPool::State {
    // A worker's remaining share of a ParallelFor: first and last block of minimumRange items, packed in one word.
    struct alignas(64) Share {
        std::atomic<uint64_t> blocks{0};
    };

    alignas(64) std::atomic<uint32_t> gate{0};  // generation, open bit, number of helpers inside
    const FunctionRef<void(uint32_t)>* job = nullptr;
    alignas(64) std::atomic<bool> busy{false};
    std::unique_ptr<Share[]> shares;
    std::vector<std::thread> threads;
};

ThreadPool::ThreadPool(uint32_t workers) : state_(std::make_unique<State>()) {
    workers = std::clamp(workers, 1u, kMaximumWorkers);
    state_->shares = std::make_unique<State::Share[]>(workers);
    state_->threads.reserve(workers - 1);
    try {
        for (uint32_t worker = 1; worker < workers; ++worker)
            state_->threads.emplace_back([this, worker] { RunHelper(worker); });
    } catch (const std::system_error&) {
        // The system refuses more threads: continue with those that started.
    } catch (const std::bad_alloc&) {}
    helperCount_ = static_cast<uint32_t>(state_->threads.size());
}

ThreadPool::~ThreadPool() {
    state_->gate.fetch_or(kStop);
    state_->gate.notify_all();
    for (std::thread& helper : state_->threads) helper.join();
}

uint32_t ThreadPool::CallersWorker() const {
    const Membership* m = FindMembership(this);
    return m ? m->worker : 0;
}

bool ThreadPool::TryTakeHelpers() {
    return helperCount_ > 0 && !FindMembership(this) && !state_->busy.exchange(true, std::memory_order_acquire);
}

void ThreadPool::RunOnWorkers(FunctionRef<void(uint32_t)> job) {
    if (!TryTakeHelpers()) return job(CallersWorker());
    FirstException thrown;
    Dispatch([&](uint32_t worker) { thrown.Run([&] { job(worker); }); });
    thrown.Rethrow();
}

void ThreadPool::ParallelFor(uint32_t count, uint32_t minimumRange, FunctionRef<void(JobRange)> job) {
    if (count == 0) return;
    if (count <= minimumRange || count == 1 || !TryTakeHelpers()) {
        job({0, count, CallersWorker()});
        return;
    }
    const uint32_t blockSize = std::max(minimumRange, 1u);
    const uint32_t blockCount = (count - 1) / blockSize + 1;
    const uint32_t workers = WorkerCount();
    uint32_t begin = 0;
    for (uint32_t worker = 0; worker < workers; ++worker) {
        const auto end = static_cast<uint32_t>(uint64_t{blockCount} * (worker + 1) / workers);
        state_->shares[worker].blocks.store(Pack(begin, end), std::memory_order_relaxed);
        begin = end;
    }
    FirstException thrown;
    const auto work = [&](uint32_t worker) {
        while (!thrown.HasAny()) {
            Blocks piece = TakeFromOwnShare(worker);
            if (piece.begin == piece.end) piece = Steal(worker);
            if (piece.begin == piece.end) return;  // other workers finish the blocks that they have taken
            const auto last = static_cast<uint32_t>(std::min<uint64_t>(uint64_t{piece.end} * blockSize, count));
            job({piece.begin * blockSize, last, worker});
        }
    };
    Dispatch([&](uint32_t worker) { thrown.Run([&] { work(worker); }); });
    thrown.Rethrow();
}

// The blocks in a word are taken at most once: a successful exchange means that they were there at that moment, so ABA
// is harmless. No memory order is needed: the gate orders the data.
ThreadPool::Blocks ThreadPool::TakeFromOwnShare(uint32_t worker) {
    std::atomic<uint64_t>& share = state_->shares[worker].blocks;
    uint64_t blocks = share.load(std::memory_order_relaxed);
    for (;;) {
        const uint32_t begin = BeginOf(blocks), end = EndOf(blocks);
        if (begin == end) return {begin, end};
        const uint32_t taken = begin + PieceOf(end - begin);
        if (share.compare_exchange_weak(blocks, Pack(taken, end), std::memory_order_relaxed)) return {begin, taken};
    }
}

// Takes the back half of the first share that is not empty. The thief runs a piece of it and keeps the rest as its own
// share, which was empty: nobody else writes to an empty share.
ThreadPool::Blocks ThreadPool::Steal(uint32_t thief) {
    const uint32_t workers = WorkerCount();
    for (uint32_t i = 1; i < workers; ++i) {
        const uint32_t victim = thief + i < workers ? thief + i : thief + i - workers;
        std::atomic<uint64_t>& share = state_->shares[victim].blocks;
        uint64_t blocks = share.load(std::memory_order_relaxed);
        while (BeginOf(blocks) != EndOf(blocks)) {
            const uint32_t begin = BeginOf(blocks), end = EndOf(blocks);
            const uint32_t middle = begin + (end - begin) / 2;
            if (!share.compare_exchange_weak(blocks, Pack(begin, middle), std::memory_order_relaxed)) continue;
            const uint32_t taken = middle + PieceOf(end - middle);
            state_->shares[thief].blocks.store(Pack(taken, end), std::memory_order_relaxed);
            return {middle, taken};
        }
    }
    return {0, 0};
}

void ThreadPool::Dispatch(FunctionRef<void(uint32_t)> job) noexcept {
    const Membership membership{this, 0, innermost};
    innermost = &membership;
    state_->job = &job;
    const uint32_t opened = (GenerationOf(state_->gate.load(std::memory_order_relaxed)) + 1) * kGeneration | kOpen;
    // An exchange, not a store: the full fence orders it before notify_all's check for sleeping threads, which is all
    // that notify_all costs without waiters.
    state_->gate.exchange(opened, std::memory_order_seq_cst);
    state_->gate.notify_all();

    job(0);

    if ((state_->gate.fetch_and(~kOpen, std::memory_order_acquire) & kInsideMask) != 0) {
        Spin spin(kFinishSpin);
        while ((state_->gate.load(std::memory_order_acquire) & kInsideMask) != 0)
            if (!spin.Pause()) std::this_thread::yield();
    }
    innermost = membership.outer;
    state_->busy.store(false, std::memory_order_release);
}

void ThreadPool::RunHelper(uint32_t worker) {
    const Membership membership{this, worker, nullptr};
    innermost = &membership;
    uint32_t joined = 0;  // the last generation entered; the first job's is 1
    for (;;) {
        Spin spin(kIdleSpin);
        uint32_t gate = state_->gate.load(std::memory_order_relaxed);
        while (!(gate & kOpen) || GenerationOf(gate) == joined) {
            if (gate & kStop) return;
            if (!spin.Pause()) {
                state_->gate.wait(gate, std::memory_order_relaxed);
                spin = Spin(kIdleSpin);
            }
            gate = state_->gate.load(std::memory_order_relaxed);
        }
        if (!state_->gate.compare_exchange_weak(gate, gate + 1, std::memory_order_acquire, std::memory_order_relaxed))
            continue;
        joined = GenerationOf(gate);
        (*state_->job)(worker);
        state_->gate.fetch_sub(1, std::memory_order_release);
    }
}

}  // namespace fulcrum
