// Puts the trees in order before a query that follows many insertions, as the first one after a level is loaded: in the
// order of their insertion leaves cost queries up to twice as much, or far more. A step decides by itself what pays off
// (BoundsTree::Optimize). Build may be called by many readers at once, everything else by the one writer.
#pragma once

#include <Fulcrum/Collision/Shapes/ParallelLoop.h>
#include <Fulcrum/Jobs/JobSystem.h>

#include <atomic>
#include <mutex>

namespace fulcrum {

class ColliderStore;

ParallelLoop LoopOn(JobSystem& jobs);

class PendingTrees {
public:
    void Note() { isDue_.store(true, std::memory_order_relaxed); }  // leaves were inserted
    // Before a step lets queries in: it reads the trees, too.
    void Suspend() { isDue_.store(false, std::memory_order_relaxed); }
    // Before a query.
    void Build(ColliderStore& colliders, JobSystem& jobs) {
        if (isDue_.load(std::memory_order_acquire)) BuildNow(colliders, jobs);
    }

private:
    void BuildNow(ColliderStore& colliders, JobSystem& jobs);

    std::atomic<bool> isDue_{false};
    std::mutex building_;
};

}  // namespace fulcrum
