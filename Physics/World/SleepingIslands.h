// The sets of bodies that fell asleep together, and wake together. Written by the Sleep stage and by WakeBody. Serial.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <cstdint>
#include <span>

namespace fulcrum {

class SleepingIslands {
public:
    static constexpr uint32_t kNone = ~0u;

    // Used while bodies wake.
    Array<uint32_t> pending, inside;

    // Adds an island of `bodies`; returns its index.
    uint32_t Add(std::span<const uint32_t> bodies);
    void Reserve(Array<uint32_t>&& bodies);  // so that Add of these asks for no memory
    void ReserveRemoval();                   // of all islands
    std::span<const uint32_t> Bodies(uint32_t island) const { return islands_[island]; }
    void Remove(uint32_t island);
    void RemoveBody(uint32_t island, uint32_t body);  // removing the last body removes the island
    uint32_t Count() const { return static_cast<uint32_t>(islands_.size() - free_.size()); }
    friend size_t HeapBytes(const SleepingIslands& sleeping);

private:
    friend struct SnapshotAccess;
    Array<Array<uint32_t>> islands_;
    Array<uint32_t> free_;
};

}  // namespace fulcrum
