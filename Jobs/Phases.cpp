// How workers synchronize. One counter, `done`, counts the blocks finished since the first phase. Block counts are
// known beforehand, so each worker proceeds through the phases independently: `done` tells whether its phase may begin
// (done has reached the sum of the earlier counts) or is over. No thread has to start a phase for the others: finishing
// the last block of a phase starts the next one.
//
// Blocks are claimed from shares: one word per worker, with the phase and the number of blocks of the share taken from
// the front (by the owner) and from the back (by thieves). Words are never reset: a claim for a later phase than the
// word's restarts it, a claim for an earlier phase fails. So a worker may stall anywhere, for any time:
// - before its claim: others take its blocks, and when it goes on its claim fails, because a phase is only over once
//   all of every share is taken;
// - after its claim: the others wait, since only this worker can finish that block.
//
// Memory order: a worker adds to `done` with release after its blocks, and begins a phase after an acquiring load saw
// the sum of all earlier phases. All additions are read-modify-writes (one release sequence) except for the leader's
// store, and the leader acquired everything before it. Claims need no order: they carry no data, and atomics of one
// word are coherent.
//
// The state is on the caller's stack: RunOnWorkers returns after all that began have returned, and starts none later.
#include <Fulcrum/Jobs/FirstException.h>
#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Jobs/Spin.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace fulcrum {
namespace {

constexpr uint32_t kMaximumShares = 64;       // further workers begin at another's share
constexpr uint32_t kMaximumBlocks = 1 << 20;  // fewer in a phase, so that a share's two counts fit 20 bits each
constexpr uint32_t kMaximumPhases = 1 << 24;
// About the time of several blocks; after that the thread waited for may need this core.
constexpr std::chrono::microseconds kBarrierSpin{100};
// Reading another worker's share takes the cache line from its owner, which costs it 0.1 us at its next claim. So a
// worker that finishes first waits a little before it steals.
constexpr uint32_t kPausesBeforeStealing = 16;

struct Claims {
    uint32_t phase, front, back;
};
uint64_t Pack(Claims c) { return uint64_t{c.phase} << 40 | uint64_t{c.front} << 20 | c.back; }
Claims Unpack(uint64_t word) {
    return {static_cast<uint32_t>(word >> 40), static_cast<uint32_t>(word >> 20) & (kMaximumBlocks - 1),
            static_cast<uint32_t>(word) & (kMaximumBlocks - 1)};
}

enum class Side { Front, Back };
constexpr uint32_t kNone = ~0u;

class PhaseRunner {
public:
    PhaseRunner(std::span<const uint32_t> blockCounts, uint32_t workers,
                FunctionRef<void(uint32_t, uint32_t, uint32_t)> kernel)
        : blockCounts_(blockCounts), kernel_(kernel), shareCount_(std::min(workers, kMaximumShares)) {}

    void Work(uint32_t worker);
    void Rethrow() const { thrown_.Rethrow(); }

private:
    void Run(uint32_t phase, uint32_t block, uint32_t worker);
    void Await(uint64_t blocks);
    void RunWithOthers(uint32_t phase, uint32_t worker, uint64_t doneAtEnd);
    uint32_t RunOwnShare(uint32_t phase, uint32_t worker);
    uint32_t RunOtherShares(uint32_t phase, uint32_t worker);
    uint32_t Claim(uint32_t phase, uint32_t share, Side side);

    // Rounded up, so that a single block is in the first share.
    uint32_t ShareBegin(uint32_t share, uint32_t count) const {
        return static_cast<uint32_t>((uint64_t{count} * share + shareCount_ - 1) / shareCount_);
    }

    struct alignas(64) Share {
        std::atomic<uint64_t> claims{0};
    };

    const std::span<const uint32_t> blockCounts_;
    const FunctionRef<void(uint32_t, uint32_t, uint32_t)> kernel_;
    const uint32_t shareCount_;
    std::atomic<uint32_t> arrived_{0};
    FirstException thrown_;
    alignas(64) std::atomic<uint64_t> done_{0};
    Share shares_[kMaximumShares];
};

// After a kernel has thrown the blocks are only counted, so that nobody waits for them.
void PhaseRunner::Run(uint32_t phase, uint32_t block, uint32_t worker) {
    if (!thrown_.HasAny()) thrown_.Run([&] { kernel_(phase, block, worker); });
}

void PhaseRunner::Await(uint64_t blocks) {
    Spin spin(kBarrierSpin);
    while (done_.load(std::memory_order_acquire) < blocks)
        if (!spin.Pause()) std::this_thread::yield();
}

// The block's index in the phase, or kNone if all of the share is taken or the phase is over.
uint32_t PhaseRunner::Claim(uint32_t phase, uint32_t share, Side side) {
    const uint32_t begin = ShareBegin(share, blockCounts_[phase]);
    const uint32_t size = ShareBegin(share + 1, blockCounts_[phase]) - begin;
    if (size == 0) return kNone;
    std::atomic<uint64_t>& word = shares_[share].claims;
    uint64_t seen = word.load(std::memory_order_relaxed);
    for (;;) {
        Claims claims = Unpack(seen);
        if (claims.phase > phase) return kNone;
        if (claims.phase < phase) claims = {phase, 0, 0};
        if (claims.front + claims.back == size) return kNone;
        const uint32_t block = side == Side::Front ? begin + claims.front++ : begin + size - ++claims.back;
        if (word.compare_exchange_weak(seen, Pack(claims), std::memory_order_relaxed)) return block;
    }
}

uint32_t PhaseRunner::RunOwnShare(uint32_t phase, uint32_t worker) {
    uint32_t ran = 0;
    for (;;) {
        const uint32_t block = Claim(phase, worker % shareCount_, Side::Front);
        if (block == kNone) return ran;
        Run(phase, block, worker);
        ++ran;
    }
}

uint32_t PhaseRunner::RunOtherShares(uint32_t phase, uint32_t worker) {
    uint32_t ran = 0;
    for (uint32_t i = 1; i < shareCount_; ++i) {
        const uint32_t victim = (worker + i) % shareCount_;
        for (;;) {
            const uint32_t block = Claim(phase, victim, Side::Back);
            if (block == kNone) break;
            Run(phase, block, worker);
            ++ran;
        }
    }
    return ran;
}

// Takes part in a phase until it is over.
void PhaseRunner::RunWithOthers(uint32_t phase, uint32_t worker, uint64_t doneAtEnd) {
    if (const uint32_t ran = RunOwnShare(phase, worker)) done_.fetch_add(ran, std::memory_order_release);
    const bool somebodyIsMissing = arrived_.load(std::memory_order_relaxed) < shareCount_;
    uint32_t turnsBeforeStealing = somebodyIsMissing ? 0 : kPausesBeforeStealing;
    Spin spin(kBarrierSpin);
    while (done_.load(std::memory_order_acquire) < doneAtEnd) {
        if (turnsBeforeStealing-- == 0) {
            if (const uint32_t ran = RunOtherShares(phase, worker)) done_.fetch_add(ran, std::memory_order_release);
        } else if (!spin.Pause()) {
            std::this_thread::yield();
        }
    }
}

void PhaseRunner::Work(uint32_t worker) {
    const bool leads = arrived_.fetch_add(1, std::memory_order_relaxed) == 0;
    bool published = true;  // done_ includes the single-block phases that this worker ran as the leader
    uint64_t earlier = 0;   // blocks of the phases before this one
    const auto phaseCount = static_cast<uint32_t>(blockCounts_.size());
    for (uint32_t phase = 0; phase < phaseCount; ++phase) {
        const uint32_t count = blockCounts_[phase];
        if (count == 1 && leads) {
            if (published) Await(earlier);
            Run(phase, 0, worker);
            published = false;
        } else if (count > 1) {
            if (!published) done_.store(earlier, std::memory_order_release);
            published = true;
            Await(earlier);
            RunWithOthers(phase, worker, earlier + count);
        }
        earlier += count;
    }
}

}  // namespace

void RunPhases(JobSystem& jobs, std::span<const uint32_t> blockCounts,
               FunctionRef<void(uint32_t, uint32_t, uint32_t)> kernel) {
    const uint32_t workers = jobs.WorkerCount();
    const uint32_t largest = blockCounts.empty() ? 0 : *std::max_element(blockCounts.begin(), blockCounts.end());
    if (workers > 1 && largest > 1 && largest < kMaximumBlocks && blockCounts.size() <= kMaximumPhases) {
        PhaseRunner runner(blockCounts, workers, kernel);
        jobs.RunOnWorkers([&](uint32_t worker) { runner.Work(worker); });
        return runner.Rethrow();
    }
    // One range of one item: on the calling thread, under its own worker number.
    jobs.ParallelFor(1, 1, [&](JobRange range) {
        const auto phaseCount = static_cast<uint32_t>(blockCounts.size());
        for (uint32_t phase = 0; phase < phaseCount; ++phase)
            for (uint32_t block = 0; block < blockCounts[phase]; ++block) kernel(phase, block, range.worker);
    });
}

}  // namespace fulcrum
