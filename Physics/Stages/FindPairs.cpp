// Colliders that moved out of their fat bounds search for pairs. Workers collect keys, which are sorted before pairs
// are created, so the order of pairs depends only on ids, not on threads or the structure of the trees. Existing pairs
// are mostly recognized by previously overlapping bounds, and colliders without pairs, as those of new bodies, need no
// look into the hash table.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>
#include <Fulcrum/Physics/Stages/PutIntoSleepers.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/Materials.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// Limit of new pairs that overlap deeply. If a step finds more, the search is aborted, bodies that deeply overlap many
// others start to disperse, and the search is repeated without the n^2 pairs of the crowd. Smaller crowds are detected
// by Collide.
constexpr uint32_t kMostDeepPairs = 1024;
constexpr uint32_t kAnyNumber = ~0u;

// What two colliders with overlapping bounds need. ALook: one of them is new where it is, and rests, and may have been
// put into a sleeping body.
enum class PairNeed : uint8_t { Nothing, Activation, Creation, ALook };

// Of two colliders whose bodies are not awake.
PairNeed AskForLook(const CollisionView& view, const PairStore& pairs, uint32_t index, uint32_t other) {
    const auto sleeps = [&](uint32_t collider) {
        const BodyDynamics& d = view.bodies.dynamics[view.colliders.colliders[collider].body];
        return d.motion == MotionType::Dynamic;
    };
    if (sleeps(index) == sleeps(other)) return PairNeed::Nothing;
    const uint32_t resting = sleeps(index) ? other : index;
    const bool isPlaced = view.colliders.colliders[resting].previous.IsEmpty();
    return isPlaced && pairs.Find(index, other) == PairStore::kNone ? PairNeed::ALook : PairNeed::Nothing;
}

// Of two colliders the first of which has moved.
PairNeed AskForPair(const CollisionView& view, const PairStore& pairs, uint32_t index, uint32_t other) {
    const Collider &self = view.colliders.colliders[index], &collider = view.colliders.colliders[other];
    // The pair exists already, or is filtered out.
    if (collider.previous.Overlaps(self.previous)) return PairNeed::Nothing;
    if (!view.bodies.dynamics[self.body].awake && !view.bodies.dynamics[collider.body].awake)
        return AskForLook(view, pairs, index, other);
    if (!MayCollide(view, self.body, collider.body)) return PairNeed::Nothing;
    const uint32_t pair = pairs.Find(index, other);
    if (pair != PairStore::kNone) return pairs.active.Contains(pair) ? PairNeed::Nothing : PairNeed::Activation;
    return ListenerAllows(view, self.body, collider.body) ? PairNeed::Creation : PairNeed::Nothing;
}

// A pair that is needed, as a number that sorts by its colliders, of which a is the lower one. Indices of colliders
// have 31 bits: as many would take 128 GB.
struct NeededPair {
    uint32_t a, b;
    bool isNew;
};
uint64_t KeyOf(const NeededPair& pair) { return uint64_t{pair.a} << 33 | uint64_t{pair.b} << 1 | pair.isNew; }
NeededPair PairOf(uint64_t key) {
    return {static_cast<uint32_t>(key >> 33), static_cast<uint32_t>(key >> 1) & 0x7FFFFFFFu, (key & 1) != 0};
}

// Records their pair if they need one, until more than mostDeep of the recorded pairs overlap deeply.
void Consider(const CollisionView& view, const PairStore& pairs, uint32_t index, uint32_t other, uint32_t mostDeep,
              WorkerFindings& findings) {
    if (findings.deepPairs > mostDeep) return;
    const PairNeed need = AskForPair(view, pairs, index, other);
    if (need == PairNeed::Nothing) return;
    if (need == PairNeed::ALook) return NoteIfPutIntoSleeper(view, index, other, findings);
    findings.deepPairs += OverlapDeeply(view, index, other);
    findings.pairs.push_back(KeyOf({std::min(index, other), std::max(index, other), need == PairNeed::Creation}));
}

// Calls visit(other) for the colliders whose fat bounds overlap those of a collider.
template <class Visit>
void VisitNeighbors(const CollisionView& view, uint32_t index, const Visit& visit) {
    const ColliderStore& store = view.colliders;
    const Collider& self = store.colliders[index];
    if (self.sensor) return;
    const uint32_t layers = view.step.settings.layerCollides[view.bodies.dynamics[self.body].layer];
    if ((layers & store.movingLayers) && !view.bodies.dynamics[self.body].dispersing)
        store.movingTree.Query(self.fat, visit);
    if (self.moving && (layers & store.staticLayers)) store.staticTree.Query(self.fat, visit);
}

// Finds the pairs of one collider.
void Search(const CollisionView& view, const PairStore& pairs, uint32_t index, uint32_t mostDeep,
            WorkerFindings& findings) {
    if (findings.deepPairs > mostDeep) return;
    VisitNeighbors(view, index, [&](uint32_t other) {
        if (view.colliders.colliders[other].queued && other < index) return;  // the other one reports the pair
        Consider(view, pairs, index, other, mostDeep, findings);
    });
}

void SearchEach(const CollisionView& view, const PairStore& pairs, uint32_t mostDeep, const StepWorkers& workers) {
    const Array<uint32_t>& moved = view.colliders.moved;
    workers.jobs.ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            Search(view, pairs, moved[i], mostDeep, workers.findings[range.worker]);
    });
}

// The same if most colliders have moved: a self-join of the tree of moving colliders.
void SearchTogether(const CollisionView& view, const PairStore& pairs, uint32_t mostDeep, const StepWorkers& workers) {
    const ColliderStore& store = view.colliders;
    const auto isQueued = [&](uint32_t i) { return store.colliders[i].queued; };
    workers.jobs.ParallelFor(store.movingTree.NodeCount(), 8, [&](JobRange range) {
        WorkerFindings& found = workers.findings[range.worker];
        const auto consider = [&](uint32_t a, uint32_t b) {
            const uint32_t low = std::min(a, b), high = std::max(a, b);
            if (isQueued(low)) Consider(view, pairs, low, high, mostDeep, found);
            else if (isQueued(high)) Consider(view, pairs, high, low, mostDeep, found);
        };
        // Node by node, because a single thread gets all of them as one range, and an aborted search must not visit n^2
        // pairs.
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
                    if (!isQueued(other) || index < other) Consider(view, pairs, index, other, mostDeep, found);
                });
            }
        });
    });
    workers.jobs.ParallelFor(static_cast<uint32_t>(store.moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            if (!store.colliders[store.moved[i]].moving)
                Search(view, pairs, store.moved[i], mostDeep, workers.findings[range.worker]);
    });
}

// Kinematic bodies search for dispersing ones, because these do not search the tree of moving colliders: each would
// find the whole crowd.
void SearchForDispersing(const CollisionView& view, const PairStore& pairs, WorkerFindings& findings) {
    const ColliderStore& store = view.colliders;
    for (uint32_t body = 0; body < view.bodies.Size(); ++body) {
        if (!view.bodies.cold[body].exists || view.bodies.dynamics[body].motion != MotionType::Kinematic) continue;
        VisitColliders(view.bodies, view.colliders, body, [&](uint32_t index) {
            if (store.colliders[index].sensor) return;
            store.movingTree.Query(store.colliders[index].fat, [&](uint32_t other) {
                if (view.bodies.dynamics[store.colliders[other].body].dispersing)
                    Consider(view, pairs, other, index, kAnyNumber, findings);
            });
        });
    }
}

void SearchAll(const CollisionView& view, const PairStore& pairs, const CrowdState& crowd, uint32_t mostDeep,
               const StepWorkers& workers) {
    if (view.colliders.MostMoved() && crowd.dispersing.empty()) SearchTogether(view, pairs, mostDeep, workers);
    else SearchEach(view, pairs, mostDeep, workers);
    if (!crowd.dispersing.empty()) SearchForDispersing(view, pairs, workers.findings.front());
}

// Whether more than mostDeep deeply overlapping pairs were found; then all recorded pairs are dropped.
bool FoundTooDeep(std::span<WorkerFindings> workers, uint64_t mostDeep) {
    uint64_t deep = 0;
    for (WorkerFindings& findings : workers) deep += std::exchange(findings.deepPairs, 0);
    if (deep <= mostDeep) return false;
    for (WorkerFindings& findings : workers) findings.pairs.clear();
    return true;
}

uint32_t AddPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t colliderA,
                 uint32_t colliderB) {
    const uint32_t bodyA = colliders.colliders[colliderA].body;
    if (bodies.dynamics[bodyA].motion != MotionType::Dynamic) std::swap(colliderA, colliderB);
    return pairs.Add(colliderA, colliderB);
}

// Initializes a new pair.
void DescribePair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t index) {
    Pair& pair = pairs.pairs[index];
    pair.bodyA = colliders.colliders[pair.colliderA].body;
    pair.bodyB = colliders.colliders[pair.colliderB].body;
    pair.fixedB = bodies.dynamics[pair.bodyB].motion != MotionType::Dynamic;
    const ColliderShape& a = colliders.shapes[pair.colliderA];
    const ColliderShape& b = colliders.shapes[pair.colliderB];
    pair.offset = a.offset || b.offset;
    pair.surface = b.shape->IsSurface();
}

// Creates new pairs and activates resting ones, from sorted keys. Pairs with surfaces have contacts from the start.
void ActivatePairs(const BodyStore& bodies, const ColliderStore& colliders, std::span<const uint64_t> keys,
                   PairStore& pairs, Array<uint32_t>& activated, const StepWorkers& workers) {
    // Where many bodies have been added, all of their pairs are: the arrays move once.
    if (!pairs.HasRoomFor(keys.size()))
        pairs.Reserve(static_cast<size_t>(std::ranges::count_if(keys, [](uint64_t key) { return PairOf(key).isNew; })));
    const std::span<uint32_t> added = workers.scratch.Allocate<uint32_t>(keys.size());
    uint32_t count = 0;
    for (size_t i = 0; i < keys.size(); ++i) {
        if (i > 0 && keys[i] == keys[i - 1]) continue;  // found by both colliders
        const auto [a, b, isNew] = PairOf(keys[i]);
        const uint32_t index = isNew ? AddPair(bodies, colliders, pairs, a, b) : pairs.Find(a, b);
        if (isNew) added[count++] = index;
        if (pairs.active.Insert(index)) activated.push_back(index);
    }
    workers.jobs.ParallelFor(count, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) DescribePair(bodies, colliders, pairs, added[i]);
    });
    for (const uint32_t index : added.first(count)) {
        if (!pairs.pairs[index].surface) continue;
        pairs.AddContact(index);
        CombineMaterials(bodies, colliders, pairs, index);
    }
}

// Reserves the lists by the size of the world, so that steps in steady state do not allocate, whichever worker does the
// work.
void ReserveLists(PairUpdates& updates, std::span<WorkerFindings> workers, size_t colliders) {
    updates.activated.reserve(colliders);
    updates.found.reserve(colliders);
    for (WorkerFindings& findings : workers) findings.pairs.reserve(colliders);
}

}  // namespace

void FindPairs(const StepContext& step, const JointStore& joints, BodyStore& bodies, ColliderStore& colliders,
               PairStore& pairs, ConstraintColoring& coloring, PairUpdates& updates, CrowdState& crowd,
               const StepWorkers& workers) {
    ReserveLists(updates, workers.findings, colliders.colliders.capacity());
    updates.activated.clear();
    EndDispersing(step, joints, pairs, bodies, colliders, crowd.dispersing, workers);
    if (!crowd.deepOverlaps.empty())
        StartDispersing(step, colliders, joints, bodies, pairs, coloring, crowd, updates.changes, workers);
    if (colliders.moved.empty()) return;
    const CollisionView view{step, bodies, colliders, joints};
    SearchAll(view, pairs, crowd, kMostDeepPairs, workers);
    if (FoundTooDeep(workers.findings, kMostDeepPairs)) {
        // Of the moved colliders' bodies, those that deeply overlap many others start to disperse.
        for (const uint32_t index : colliders.moved) crowd.deepOverlaps.push_back(colliders.colliders[index].body);
        StartDispersing(step, colliders, joints, bodies, pairs, coloring, crowd, updates.changes, workers);
        SearchAll(view, pairs, crowd, kAnyNumber, workers);
        FoundTooDeep(workers.findings, kAnyNumber);
    }
    Array<uint64_t>& found = updates.found;
    found.clear();
    for (WorkerFindings& findings : workers.findings) {
        found.insert(found.end(), findings.pairs.begin(), findings.pairs.end());
        findings.pairs.clear();
    }
    std::sort(found.begin(), found.end());
    ActivatePairs(bodies, colliders, found, pairs, updates.activated, workers);
}

void ForgetMoved(ColliderStore& colliders, SensorStore& sensors, JobSystem& jobs) {
    const Array<uint32_t>& moved = colliders.moved;
    if (moved.empty()) return;
    jobs.ParallelFor(static_cast<uint32_t>(moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            Collider& collider = colliders.colliders[moved[i]];
            collider.queued = false;
            collider.previous = collider.fat;
        }
    });
    if (!sensors.IsEmpty())
        for (uint32_t index : moved) sensors.changed.push_back(colliders.colliders[index].body);
    colliders.moved.clear();
}

}  // namespace fulcrum
