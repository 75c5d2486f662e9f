// Colliders: the pieces of the bodies, as the broad phase sees them. A compound has one per child, in a run of
// consecutive ones, every other shape one. A mutable compound that outgrows its run gets further ones; a removed child
// leaves its collider empty, without a shape. There are trees of static colliders, of those that may move, and of
// sensors.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

#include <vector>

namespace fulcrum {

// What the search for pairs reads: one line.
struct alignas(64) Collider {
    Bounds fat;  // m, about ColliderStore::boundsOrigin: the piece stays inside until it is moved out
    // As of the last search. Two colliders whose previous bounds overlap have their pair already. Empty: search for
    // all.
    Bounds previous;
    uint32_t body = 0;
    bool moving = false;  // which tree
    bool queued = false;  // in ColliderStore::moved
    bool sensor = false;  // in a tree of its own, so that only Sense, and queries that ask for sensors, find it
};
static_assert(sizeof(Collider) == 64);

// The piece itself.
struct ColliderShape {
    const Shape* shape = nullptr;  // no compound; kept alive by the body's shape; null: empty
    bool offset = false;           // not at the body's center frame
    bool onOrigin = false;         // `local` is seen from BodyChildren::origin
    RelativePose local;            // of the shape's center frame in the body's: read it by LocalOf (WorldState.h)
};

// Consecutive colliders of a body.
struct ColliderRun {
    uint32_t first = 0, count = 0;
    uint32_t next = ~0u;  // index into ColliderStore::runs
};

class ColliderStore {
public:
    static constexpr uint32_t kNone = ~0u;
    std::vector<Collider> colliders;
    std::vector<ColliderShape> shapes;  // same index
    // m, world: where all bounds are measured from. They are float, fine near it and coarse far from it, so it is near
    // the first body of an empty world, in steps of a kilometer.
    Position boundsOrigin = Position::Zero();
    BoundsTree staticTree, movingTree, sensorTree;
    uint32_t movingLayers = 0, staticLayers = 0;  // bit i: a body of layer i is, or was, in the tree
    std::vector<uint32_t> moved;                  // whose pairs must be searched
    bool movedHasEmpty = false;                   // some of them have been removed since
    std::vector<ColliderRun> runs;                // bodies' further ones

    BoundsTree& TreeOf(const Collider& c) { return c.sensor ? sensorTree : c.moving ? movingTree : staticTree; }
    uint32_t Allocate(uint32_t count);  // index of the first of `count` consecutive ones
    void Free(uint32_t first, uint32_t count);
    uint32_t AddRun(uint32_t count);  // index of a further run
    void FreeRuns(uint32_t run);      // this one and those that follow it
    void Queue(uint32_t collider) {
        if (colliders[collider].queued) return;
        colliders[collider].queued = true;
        moved.push_back(collider);
    }
    // Whether so many moved that it costs less to look at the whole moving tree than at each of them.
    bool MostMoved() const { return 2 * moved.size() >= movingTree.Size(); }
    friend size_t HeapBytes(const ColliderStore& store);

private:
    friend struct SnapshotAccess;
    std::vector<std::vector<uint32_t>> free_;  // by count: first indices of runs that were given back
    std::vector<uint32_t> freeRuns_;
};

}  // namespace fulcrum
