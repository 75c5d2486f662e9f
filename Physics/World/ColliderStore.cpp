#include <Fulcrum/Physics/World/ColliderStore.h>

#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

namespace fulcrum {

uint32_t ColliderStore::Allocate(uint32_t count) {
    if (count < free_.size() && !free_[count].empty()) {
        const uint32_t first = free_[count].back();
        free_[count].pop_back();
        return first;
    }
    const uint32_t first = static_cast<uint32_t>(colliders.size());
    ReserveAtLeast(colliders, colliders.size() + count);
    ReserveAtLeast(shapes, colliders.size() + count);
    colliders.resize(colliders.size() + count);
    shapes.resize(colliders.size());
    return first;
}

void ColliderStore::Reserve(size_t more) {
    ReserveMore(colliders, more);
    ReserveMore(shapes, more);
    ReserveMore(moved, more);
}

void ColliderStore::Free(uint32_t first, uint32_t count) {
    for (uint32_t i = first; i < first + count; ++i) {
        colliders[i] = {};
        shapes[i] = {};
    }
    if (count >= free_.size()) free_.resize(count + 1);
    free_[count].push_back(first);
}

uint32_t ColliderStore::AddRun(uint32_t count) {
    uint32_t run = static_cast<uint32_t>(runs.size());
    if (freeRuns_.empty()) {
        runs.emplace_back();
    } else {
        run = freeRuns_.back();
        freeRuns_.pop_back();
    }
    runs[run] = {Allocate(count), count, kNone};
    return run;
}

void ColliderStore::FreeRuns(uint32_t run) {
    while (run != kNone) {
        Free(runs[run].first, runs[run].count);
        freeRuns_.push_back(run);
        run = runs[run].next;
    }
}

size_t HeapBytes(const ColliderStore& store) {
    const auto& [colliders, shapes, boundsOrigin, staticTree, movingTree, sensorTree, movingLayers, staticLayers, moved,
                 movedHasEmpty, runs, free, freeRuns] = store;
    return HeapBytes(colliders, shapes, boundsOrigin, staticTree, movingTree, sensorTree, movingLayers, staticLayers,
                     moved, movedHasEmpty, runs, free, freeRuns);
}

}  // namespace fulcrum
