#include <Fulcrum/Physics/World/SleepingIslands.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

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
    const auto& [islands, free] = sleeping;
    return HeapBytes(islands, free);
}

}  // namespace fulcrum
