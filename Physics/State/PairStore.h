// Pairs of colliders whose fat bounds overlap, with their manifolds; a pair lives as long as the overlap lasts. Pairs keep
// their index, so pairs, records and colours refer to each other by it. A pair is active while one of its bodies is awake.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactRecord.h>

#include <vector>

namespace fulcrum {

struct Pair {
    uint32_t colliderA = 0, colliderB = 0;  // A's body is dynamic, B's any
    uint32_t bodyA = 0, bodyB = 0;
    PairCache cache;
    uint32_t features[Manifold::kMaxPoints] = {0, 0, 0, 0};
    RelativePose reference;      // of B in A when the manifold was found
    uint32_t activePlace = ~0u;  // index into PairStore::active; ~0: not active
    ColourSlot colour;
    bool exists = false;
    bool fixedB = false;         // B's body is not dynamic
    bool offset = false;         // a collider is not at its body's centre frame (child of a compound)
    bool touching = false;       // was active, with points, in the last step
    uint8_t pointCount = 0;      // of the record, as found at `reference`
};

class PairStore {
public:
    std::vector<Pair> pairs;
    std::vector<ContactRecord> records;  // same index
    std::vector<uint32_t> active;        // in no order

    // Index of the pair of two colliders, or kNone.
    static constexpr uint32_t kNone = ~0u;
    uint32_t Find(uint32_t colliderA, uint32_t colliderB) const;
    uint32_t Add(uint32_t colliderA, uint32_t colliderB);  // not there yet
    void Remove(uint32_t index);                           // not coloured
    void Activate(uint32_t index);
    void Deactivate(uint32_t index);
    size_t MemoryUsed() const;

private:
    static uint64_t Key(uint32_t a, uint32_t b) {
        return a < b ? (uint64_t(a) << 32 | b) : (uint64_t(b) << 32 | a);
    }
    uint32_t Home(uint64_t key) const;
    void Grow();

    // Open addressing with linear probing; at most half full. Only an index: its order influences nothing.
    struct Entry {
        uint64_t key;
        uint32_t index = kNone;
    };
    std::vector<Entry> table_;
    std::vector<uint32_t> free_;
    uint32_t size_ = 0;
};

}  // namespace fulcrum
