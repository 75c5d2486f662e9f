// Colliders: the pieces of the bodies, as the broad phase sees them. A compound has one per child, consecutive, every other
// shape one. Two trees keep what moves apart from what never does.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

#include <vector>

namespace fulcrum {

// What the search for pairs reads: one line.
struct alignas(64) Collider {
    Bounds fat;                          // world, m: the piece stays inside until it is moved out
    // As of the last search. Two colliders whose previous bounds overlap have their pair already. Empty: search for all.
    Bounds previous;
    uint32_t body = 0;
    bool moving = false;                 // which tree
    bool queued = false;                 // in ColliderStore::moved
};
static_assert(sizeof(Collider) == 64);

// The piece itself.
struct ColliderShape {
    const Shape* shape = nullptr;        // no compound; kept alive by the body's shape
    bool offset = false;                 // `local` is not the identity
    RelativePose local;                  // of the shape's centre frame in the body's
};

class ColliderStore {
public:
    std::vector<Collider> colliders;
    std::vector<ColliderShape> shapes;           // same index
    BoundsTree fixedTree, movingTree;
    uint32_t movingLayers = 0, fixedLayers = 0;  // bit i: a body of layer i is, or was, in the tree
    std::vector<uint32_t> moved;                 // whose pairs must be searched

    BoundsTree& TreeOf(const Collider& c) { return c.moving ? movingTree : fixedTree; }
    uint32_t Allocate(uint32_t count);           // index of the first of `count` consecutive ones
    void Free(uint32_t first, uint32_t count);
    void Queue(uint32_t collider) {
        if (colliders[collider].queued) return;
        colliders[collider].queued = true;
        moved.push_back(collider);
    }
    size_t MemoryUsed() const {
        return colliders.capacity() * sizeof(Collider) + shapes.capacity() * sizeof(ColliderShape) + fixedTree.MemoryUsed() + movingTree.MemoryUsed() +
               moved.capacity() * sizeof(uint32_t);
    }

private:
    std::vector<std::vector<uint32_t>> free_;  // by count: first indices of runs that were given back
};

}  // namespace fulcrum
