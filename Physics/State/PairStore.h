// Pairs of colliders whose fat bounds overlap, with their manifolds; a pair lives as long as the overlap lasts. Pairs keep
// their index, so pairs, records and colours refer to each other by it. A pair is active while one of its bodies is awake.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactRecord.h>

#include <Fulcrum/Physics/State/IndexSet.h>

#include <vector>

namespace fulcrum {

struct alignas(64) Pair {
    // First line: what a pair that keeps its manifold is read for.
    uint32_t bodyA = 0, bodyB = 0;          // A is dynamic, B any
    uint32_t colliderA = 0, colliderB = 0;
    const ConvexShape* shapeA = nullptr;
    const ConvexShape* shapeB = nullptr;
    RelativePose reference;      // of piece B in piece A when the manifold was found
    uint8_t pointCount = 0;      // of the record, as found at `reference`
    bool exists : 1 = false;
    bool fixedB : 1 = false;     // B's body is not dynamic
    bool offset : 1 = false;     // a piece is not at its body's centre frame (child of a compound)
    bool touching : 1 = false;   // was active, with points, in the last step
    // Second line.
    PairCache cache;
    uint32_t features[Manifold::kMaxPoints] = {0, 0, 0, 0};
    ColourSlot colour;
};
static_assert(sizeof(Pair) == 128);

class PairStore {
public:
    std::vector<Pair> pairs;
    std::vector<ContactRecord> records;  // same index
    IndexSet active;

    // Index of the pair of two colliders, or kNone.
    static constexpr uint32_t kNone = ~0u;
    uint32_t Find(uint32_t colliderA, uint32_t colliderB) const;
    uint32_t Add(uint32_t colliderA, uint32_t colliderB);  // not there yet
    void Remove(uint32_t index);                           // not coloured
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
