#include <Fulcrum/Physics/World/ColliderStore.h>

#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

#include <algorithm>

namespace fulcrum {

uint32_t ColliderStore::Allocate(uint32_t count) {
    if (HasFree(count)) {
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
    const size_t size = colliders.size() + more;
    ReserveAtLeast(colliders, size);
    ReserveAtLeast(shapes, size);
    ReserveRoom(moved, size);
}

// Lists of lengths that were never freed are added last: they are part of the state.
void ColliderStore::ReserveFree(uint32_t count, uint32_t run) {
    uint32_t longest = count;
    size_t all = 1;
    for (uint32_t i = run; i != kNone; i = runs[i].next, ++all) longest = std::max(longest, runs[i].count);
    ReserveMore(freeRuns_, all);
    ReserveRoom(free_, size_t{longest} + 1);
    const size_t lists = free_.size();
    if (longest >= lists) free_.resize(size_t{longest} + 1);
    try {
        ReserveMore(free_[count], all);
        for (uint32_t i = run; i != kNone; i = runs[i].next) ReserveMore(free_[runs[i].count], all);
    } catch (...) {
        free_.resize(lists);
        throw;
    }
}

void ColliderStore::Free(uint32_t first, uint32_t count) {
    for (uint32_t i = first; i < first + count; ++i) {
        colliders[i] = {};
        shapes[i] = {};
    }
    if (count >= free_.size()) free_.resize(count + 1);
    free_[count].push_back(first);
}

uint32_t ColliderStore::ReserveRun(uint32_t before) {
    if (freeRuns_.empty()) ReserveMore(runs, 1);
    const uint32_t count = LengthOfNextRun(before);
    return HasFree(count) ? 0 : count;
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
