#include <Fulcrum/Physics/World/SleepingIslands.h>

#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

#include <algorithm>

namespace fulcrum {

uint32_t SleepingIslands::Add(std::span<const uint32_t> bodies) {
    uint32_t island;
    if (!free_.empty()) {
        island = free_.back();
        free_.pop_back();
    } else {
        island = static_cast<uint32_t>(islands_.size());
        islands_.emplace_back();
    }
    islands_[island].assign(bodies.begin(), bodies.end());
    return island;
}

void SleepingIslands::ReserveRemoval() { ReserveRoom(free_, islands_.size()); }

void SleepingIslands::Reserve(Array<uint32_t>&& room) {
    if (free_.empty()) {
        ReserveMore(islands_, 1);
        ReserveRoom(free_, islands_.size() + 1);
        islands_.emplace_back();
        free_.push_back(static_cast<uint32_t>(islands_.size()) - 1);
    }
    islands_[free_.back()].swap(room);
    islands_[free_.back()].clear();
}

void SleepingIslands::Remove(uint32_t island) {
    islands_[island].clear();
    free_.push_back(island);
}

void SleepingIslands::RemoveBody(uint32_t island, uint32_t body) {
    Array<uint32_t>& bodies = islands_[island];
    bodies.erase(std::find(bodies.begin(), bodies.end(), body));
    if (bodies.empty()) Remove(island);
}

size_t HeapBytes(const SleepingIslands& sleeping) {
    const auto& [pending, inside, islands, free] = sleeping;
    return HeapBytes(pending, inside, islands, free);
}

}  // namespace fulcrum
