// Colliders: the proxies of bodies in the broad phase. A compound has one per child, in a run of consecutive indices,
// every other shape one. A mutable compound that outgrows its run gets further runs; a removed child leaves its
// collider empty, without a shape. There are separate trees for static colliders, for those that may move, and for
// sensors.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>
#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Memory.h>

namespace fulcrum {

// Data for the search of pairs: one cache line.
struct alignas(64) Collider {
    Bounds fat;  // m, relative to ColliderStore::boundsOrigin: fat bounds, updated when the collider leaves them
    // Fat bounds at the last search. Two colliders whose previous bounds overlap already have their pair. Empty: search
    // for all.
    Bounds previous;
    uint32_t body = 0;
    bool moving = false;  // which tree
    bool queued = false;  // in ColliderStore::moved
    bool sensor = false;  // in a separate tree, so that only Sense, and queries for sensors, find it
};
static_assert(sizeof(Collider) == 64);

// The shape of a collider.
struct ColliderShape {
    const Shape* shape = nullptr;  // not a compound; kept alive by the body's shape; null: empty
    bool offset = false;           // not at the body's center frame
    bool onOrigin = false;         // `local` is relative to BodyChildren::origin
    RelativePose local;            // pose of the shape's center frame in the body's: read it by LocalOf (WorldState.h)
};

// Consecutive colliders of a body.
struct ColliderRun {
    uint32_t first = 0, count = 0;
    uint32_t next = ~0u;  // index into ColliderStore::runs
};

class ColliderStore {
public:
    static constexpr uint32_t kNone = ~0u;
    Array<Collider> colliders;
    Array<ColliderShape> shapes;  // same index
    // m, world: the origin of all bounds. They are floats, precise near it, so it is placed near the first body of an
    // empty world, in steps of a kilometer.
    Position boundsOrigin = Position::Zero();
    BoundsTree staticTree, movingTree, sensorTree;
    uint32_t movingLayers = 0, staticLayers = 0;  // bit i: a body of layer i is, or was, in the tree
    Array<uint32_t> moved;                        // colliders whose pairs must be searched
    bool movedHasEmpty = false;                   // some of them have been removed
    Array<ColliderRun> runs;                      // further runs of bodies

    const BoundsTree& TreeOf(const Collider& c) const {
        return c.sensor ? sensorTree : c.moving ? movingTree : staticTree;
    }
    BoundsTree& TreeOf(const Collider& c) { return c.sensor ? sensorTree : c.moving ? movingTree : staticTree; }
    // For so many more colliders, and for the list of those that move.
    void Reserve(size_t more);
    bool HasFree(uint32_t count) const { return count < free_.size() && !free_[count].empty(); }
    // For Free, of a body's colliders.
    void ReserveFree(uint32_t count, uint32_t run);
    uint32_t Allocate(uint32_t count);  // index of the first of `count` consecutive ones
    void Free(uint32_t first, uint32_t count);
    uint32_t AddRun(uint32_t count);  // index of a further run
    // Each further run of a body is as long as all before it, so that there are few.
    static uint32_t LengthOfNextRun(uint32_t before) { return before > 8 ? before : 8; }
    // For AddRun of a body with so many colliders. Returns how many it adds to the store.
    uint32_t ReserveRun(uint32_t before);
    void FreeRuns(uint32_t run);  // this one and those that follow it
    void Queue(uint32_t collider) {
        if (colliders[collider].queued) return;
        colliders[collider].queued = true;
        moved.push_back(collider);
    }
    // Whether so many moved that processing the whole moving tree is cheaper than each of them.
    bool MostMoved() const { return 2 * moved.size() >= movingTree.Size(); }
    friend size_t HeapBytes(const ColliderStore& store);

private:
    friend struct SnapshotAccess;
    Array<Array<uint32_t>> free_;  // by count: first indices of freed runs
    Array<uint32_t> freeRuns_;
};

}  // namespace fulcrum
