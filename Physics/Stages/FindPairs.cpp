// Pairs are found by whoever moved. Workers collect keys, which are sorted before any pair is made: the order of the
// pairs depends on ids alone, not on threads nor on the shape of the trees. Pairs that exist are recognized by their
// bounds, most of the time: the table of pairs is asked about new ones only.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/Materials.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// New pairs that overlap deeply. Where a step finds more, the search is given up, bodies that deeply overlap many
// others start to disperse, and pairs are searched for anew, without those of the crowd, which would be n^2. Crowds
// with fewer pairs are left to Collide to find.
constexpr uint32_t kMostDeepPairs = 1024;
constexpr uint32_t kAnyNumber = ~0u;

// Whether the bounds of two colliders, of which the first has moved, ask for a pair that is not active.
bool AskForPair(const WorldState& world, uint32_t index, uint32_t other) {
    const Collider &self = world.colliders.colliders[index], &collider = world.colliders.colliders[other];
    if (collider.previous.Overlaps(self.previous)) return false;  // they have their pair, or may not have one
    if (!MayCollide(world, self.body, collider.body)) return false;
    const uint32_t pair = world.pairs.Find(index, other);
    return pair == PairStore::kNone ? ListenerAllows(world, self.body, collider.body)
                                    : !world.pairs.active.Contains(pair);
}

uint64_t KeyOf(uint32_t a, uint32_t b) { return a < b ? uint64_t(a) << 32 | b : uint64_t(b) << 32 | a; }

// Notes their pair if they are to have one, until more than mostDeep of those found overlap deeply.
void Consider(const WorldState& world, uint32_t index, uint32_t other, uint32_t mostDeep, WorkerFindings& findings) {
    if (findings.deepPairs > mostDeep || !AskForPair(world, index, other)) return;
    findings.deepPairs += OverlapDeeply(world, index, other);
    findings.pairs.push_back(KeyOf(index, other));
}

// Calls visit(other) for the colliders whose fat bounds overlap those of a collider.
template <class Visit>
void VisitNeighbors(const WorldState& world, uint32_t index, const Visit& visit) {
    const ColliderStore& store = world.colliders;
    const Collider& self = store.colliders[index];
    if (self.sensor) return;
    const uint32_t layers = world.settings.layerCollides[world.bodies.dynamics[self.body].layer];
    if ((layers & store.movingLayers) && !world.bodies.dynamics[self.body].dispersing)
        store.movingTree.Query(self.fat, visit);
    if (self.moving && (layers & store.staticLayers)) store.staticTree.Query(self.fat, visit);
}

// Pairs of one collider.
void Search(const WorldState& world, uint32_t index, uint32_t mostDeep, WorkerFindings& findings) {
    if (findings.deepPairs > mostDeep) return;
    VisitNeighbors(world, index, [&](uint32_t other) {
        if (world.colliders.colliders[other].queued && other < index) return;  // it reports the pair itself
        Consider(world, index, other, mostDeep, findings);
    });
}

void SearchEach(const WorldState& world, std::span<WorkerFindings> workers, uint32_t mostDeep) {
    const std::vector<uint32_t>& moved = world.colliders.moved;
    world.jobs->ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) Search(world, moved[i], mostDeep, workers[range.worker]);
    });
}

// The same where most have moved: a self-join of the tree of moving colliders.
void SearchTogether(const WorldState& world, std::span<WorkerFindings> workers, uint32_t mostDeep) {
    const ColliderStore& store = world.colliders;
    const auto isQueued = [&](uint32_t i) { return store.colliders[i].queued; };
    world.jobs->ParallelFor(store.movingTree.NodeCount(), 8, [&](JobRange range) {
        WorkerFindings& found = workers[range.worker];
        const auto consider = [&](uint32_t a, uint32_t b) {
            const uint32_t low = std::min(a, b), high = std::max(a, b);
            if (isQueued(low)) Consider(world, low, high, mostDeep, found);
            else if (isQueued(high)) Consider(world, high, low, mostDeep, found);
        };
        // Node by node, since one thread alone gets all of them as one range: a search that is given up must not go on
        // to visit n^2 pairs.
        for (uint32_t node = range.begin; node < range.end && found.deepPairs <= mostDeep; ++node)
            store.movingTree.VisitPairs(node, node + 1, consider);
        if (found.deepPairs > mostDeep) return;
        store.movingTree.VisitGroups(range.begin, range.end, [&](const Bounds& all, std::span<const uint32_t> ids) {
            bool meets = false;
            store.staticTree.Query(all, [&](uint32_t) { meets = true; });
            if (!meets) return;
            for (uint32_t index : ids) {
                if (!isQueued(index)) continue;
                store.staticTree.Query(store.colliders[index].fat, [&](uint32_t other) {
                    if (!isQueued(other) || index < other) Consider(world, index, other, mostDeep, found);
                });
            }
        });
    });
    world.jobs->ParallelFor(static_cast<uint32_t>(store.moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            if (!store.colliders[store.moved[i]].moving) Search(world, store.moved[i], mostDeep, workers[range.worker]);
    });
}

// Kinematic bodies search for dispersing ones. These do not search the tree of what moves themselves: each would find
// all of the crowd.
void SearchForDispersing(const WorldState& world, WorkerFindings& findings) {
    const ColliderStore& store = world.colliders;
    for (uint32_t body = 0; body < world.bodies.Size(); ++body) {
        if (!world.bodies.cold[body].exists || world.bodies.dynamics[body].motion != MotionType::Kinematic) continue;
        VisitColliders(world, body, [&](uint32_t index) {
            if (store.colliders[index].sensor) return;
            store.movingTree.Query(store.colliders[index].fat, [&](uint32_t other) {
                if (world.bodies.dynamics[store.colliders[other].body].dispersing)
                    Consider(world, other, index, kAnyNumber, findings);
            });
        });
    }
}

void SearchAll(const WorldState& world, const CrowdState& crowd, std::span<WorkerFindings> workers, uint32_t mostDeep) {
    if (world.colliders.MostMoved() && crowd.dispersing.empty()) SearchTogether(world, workers, mostDeep);
    else SearchEach(world, workers, mostDeep);
    if (!crowd.dispersing.empty()) SearchForDispersing(world, workers.front());
}

// Whether more than mostDeep pairs that overlap deeply were found; then all that was found is dropped.
bool FoundTooDeep(std::span<WorkerFindings> workers, uint64_t mostDeep) {
    uint64_t deep = 0;
    for (WorkerFindings& findings : workers) deep += std::exchange(findings.deepPairs, 0);
    if (deep <= mostDeep) return false;
    for (WorkerFindings& findings : workers) findings.pairs.clear();
    return true;
}

// Bodies that have moved start to disperse, as far as they overlap many others deeply.
void DisperseMoved(WorldState& world, CrowdState& crowd, std::span<PairChange> changes, ScratchArena& scratch) {
    std::vector<uint32_t> bodies;
    for (const uint32_t index : world.colliders.moved) bodies.push_back(world.colliders.colliders[index].body);
    StartDispersing(world, crowd.dispersing, bodies, changes, scratch);
}

// The searches of this step are over.
void ForgetMoved(WorldState& world) {
    ColliderStore& store = world.colliders;
    world.jobs->ParallelFor(static_cast<uint32_t>(store.moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            Collider& collider = store.colliders[store.moved[i]];
            collider.queued = false;
            collider.previous = collider.fat;
        }
    });
    if (!world.sensors.IsEmpty())
        for (uint32_t index : store.moved) world.sensors.changed.push_back(store.colliders[index].body);
    store.moved.clear();
}

uint32_t AddPair(WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    const uint32_t bodyA = world.colliders.colliders[colliderA].body;
    if (world.bodies.dynamics[bodyA].motion != MotionType::Dynamic) std::swap(colliderA, colliderB);
    return world.pairs.Add(colliderA, colliderB);
}

// Writes what is known of a pair that was added.
void DescribePair(WorldState& world, uint32_t index) {
    Pair& pair = world.pairs.pairs[index];
    pair.bodyA = world.colliders.colliders[pair.colliderA].body;
    pair.bodyB = world.colliders.colliders[pair.colliderB].body;
    pair.fixedB = world.bodies.dynamics[pair.bodyB].motion != MotionType::Dynamic;
    const ColliderShape& a = world.colliders.shapes[pair.colliderA];
    const ColliderShape& b = world.colliders.shapes[pair.colliderB];
    pair.offset = a.offset || b.offset;
    pair.shapeA = static_cast<const ConvexShape*>(a.shape);  // what moves freely has a volume
    pair.shapeB = b.shape;
    pair.surface = b.shape->IsSurface();
    CombineMaterials(world, index);
}

// Of keys, sorted: pairs that are new, and pairs that rest.
void ActivatePairs(WorldState& world, std::span<const uint64_t> keys, std::vector<uint32_t>& activated,
                   ScratchArena& scratch) {
    const std::span<uint32_t> added = scratch.Allocate<uint32_t>(keys.size());
    uint32_t count = 0;
    for (uint64_t key : keys) {
        const uint32_t a = static_cast<uint32_t>(key >> 32), b = static_cast<uint32_t>(key);
        uint32_t index = world.pairs.Find(a, b);
        if (index == PairStore::kNone) added[count++] = index = AddPair(world, a, b);
        if (world.pairs.active.Insert(index)) activated.push_back(index);
    }
    world.jobs->ParallelFor(count, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) DescribePair(world, added[i]);
    });
}

// The lists get room by the size of the world, so that no step of a settled one allocates, whichever worker does what.
void ReserveLists(PairUpdates& updates, std::span<WorkerFindings> workers, size_t colliders) {
    updates.activated.reserve(colliders);
    updates.found.reserve(colliders);
    for (WorkerFindings& findings : workers) findings.pairs.reserve(colliders);
}

}  // namespace

void FindPairs(WorldState& world, PairUpdates& updates, CrowdState& crowd, std::span<WorkerFindings> workers,
               ScratchArena& scratch) {
    ReserveLists(updates, workers, world.colliders.colliders.capacity());
    updates.activated.clear();
    EndDispersing(world, crowd.dispersing, scratch);
    if (!crowd.deepOverlaps.empty())
        StartDispersing(world, crowd.dispersing, crowd.deepOverlaps, updates.changes, scratch);
    crowd.deepOverlaps.clear();
    if (world.colliders.moved.empty()) return;
    SearchAll(world, crowd, workers, kMostDeepPairs);
    if (FoundTooDeep(workers, kMostDeepPairs)) {
        DisperseMoved(world, crowd, updates.changes, scratch);
        SearchAll(world, crowd, workers, kAnyNumber);
        FoundTooDeep(workers, kAnyNumber);
    }
    std::vector<uint64_t>& found = updates.found;
    found.clear();
    for (WorkerFindings& findings : workers) {
        found.insert(found.end(), findings.pairs.begin(), findings.pairs.end());
        findings.pairs.clear();
    }
    std::sort(found.begin(), found.end());
    ActivatePairs(world, found, updates.activated, scratch);
    ForgetMoved(world);
}

}  // namespace fulcrum
