#include <Fulcrum/Physics/World/PendingTrees.h>

#include <Fulcrum/Physics/World/ColliderStore.h>

namespace fulcrum {

ParallelLoop LoopOn(JobSystem& jobs) {
    return [&jobs](uint32_t count, const Function<void(uint32_t)>& job) {
        jobs.ParallelFor(count, 1, [&](JobRange range) {
            for (uint32_t i = range.begin; i < range.end; ++i) job(i);
        });
    };
}

void PendingTrees::BuildNow(ColliderStore& colliders, JobSystem& jobs) {
    const std::lock_guard<std::mutex> guard(building_);
    if (!isDue_.load(std::memory_order_relaxed)) return;
    for (BoundsTree* tree : {&colliders.staticTree, &colliders.movingTree, &colliders.sensorTree})
        if (tree->IsMostlyPending()) tree->Rebuild(LoopOn(jobs));
    isDue_.store(false, std::memory_order_release);
}

}  // namespace fulcrum
