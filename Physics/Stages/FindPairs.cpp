// Pairs are found by whoever moved. Workers collect keys, which are sorted before any pair is made: the order of the
// pairs depends on ids alone, not on threads nor on the shape of the trees. Pairs that exist are recognized by their
// bounds, most of the time: the table of pairs is asked about new ones only.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>

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

// Calls visit(other) for what the bounds of a collider meet.
template <class Visit>
void VisitNeighbors(const WorldState& world, uint32_t index, const Visit& visit) {
    const ColliderStore& store = world.colliders;
    const Collider& self = store.colliders[index];
    if (self.sensor) return;
    const uint32_t layers = world.settings.layerCollides[world.bodies.dynamics[self.body].layer];
    if ((layers & store.movingLayers) && !world.bodies.dynamics[self.body].dispersing)
        store.movingTree.Query(self.fat, visit);
    if (self.moving && (layers & store.fixedLayers)) store.fixedTree.Query(self.fat, visit);
}

// What one collider meets.
void Search(const WorldState& world, uint32_t index, uint32_t mostDeep, WorkerFindings& findings) {
    if (findings.deepPairs > mostDeep) return;
    VisitNeighbors(world, index, [&](uint32_t other) {
        if (world.colliders.colliders[other].queued && other < index) return;  // it reports the pair itself
        Consider(world, index, other, mostDeep, findings);
    });
}

void SearchEach(WorldState& world, uint32_t mostDeep) {
    const std::vector<uint32_t>& moved = world.colliders.moved;
    world.jobs->ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            Search(world, moved[i], mostDeep, world.findings[range.worker]);
    });
}

// The same where most have moved: what moves meets what moves, neighbors with neighbors.
void SearchTogether(WorldState& world, uint32_t mostDeep) {
    const ColliderStore& store = world.colliders;
    const auto isQueued = [&](uint32_t i) { return store.colliders[i].queued; };
    world.jobs->ParallelFor(store.movingTree.NodeCount(), 8, [&](JobRange range) {
        WorkerFindings& found = world.findings[range.worker];
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
            store.fixedTree.Query(all, [&](uint32_t) { meets = true; });
            if (!meets) return;
            for (uint32_t index : ids) {
                if (!isQueued(index)) continue;
                store.fixedTree.Query(store.colliders[index].fat, [&](uint32_t other) {
                    if (!isQueued(other) || index < other) Consider(world, index, other, mostDeep, found);
                });
            }
        });
    });
    world.jobs->ParallelFor(static_cast<uint32_t>(store.moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            if (!store.colliders[store.moved[i]].moving)
                Search(world, store.moved[i], mostDeep, world.findings[range.worker]);
    });
}

// Kinematic bodies search for dispersing ones. These do not search the tree of what moves themselves: each would find
// all of the crowd.
void SearchForDispersing(WorldState& world) {
    if (world.dispersing.empty()) return;
    const ColliderStore& store = world.colliders;
    WorkerFindings& findings = world.findings.front();
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

void SearchAll(WorldState& world, uint32_t mostDeep) {
    if (world.colliders.MostMoved() && world.dispersing.empty()) SearchTogether(world, mostDeep);
    else SearchEach(world, mostDeep);
    SearchForDispersing(world);
}

// Whether more than mostDeep pairs that overlap deeply were found; then all that was found is dropped.
bool FoundTooDeep(WorldState& world, uint64_t mostDeep) {
    uint64_t deep = 0;
    for (WorkerFindings& findings : world.findings) deep += std::exchange(findings.deepPairs, 0);
    if (deep <= mostDeep) return false;
    for (WorkerFindings& findings : world.findings) findings.pairs.clear();
    return true;
}

// Bodies that have moved start to disperse, as far as they overlap many others deeply.
void DisperseMoved(WorldState& world) {
    std::vector<uint32_t> bodies;
    for (const uint32_t index : world.colliders.moved) bodies.push_back(world.colliders.colliders[index].body);
    StartDispersing(world, bodies);
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
        for (uint32_t index : store.moved) world.sensors.touched.push_back(store.colliders[index].body);
    store.moved.clear();
}

float Combine(CombineRule rule, float a, float b) {
    switch (rule) {
        case CombineRule::GeometricMean: return std::sqrt(a * b);
        case CombineRule::Average: return 0.5f * (a + b);
        case CombineRule::Minimum: return std::min(a, b);
        case CombineRule::Multiply: return a * b;
        case CombineRule::Maximum: return std::max(a, b);
    }
    return 0;
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
void ActivatePairs(WorldState& world, const std::vector<uint64_t>& keys) {
    const std::span<uint32_t> added = world.scratch.Allocate<uint32_t>(keys.size());
    uint32_t count = 0;
    for (uint64_t key : keys) {
        const uint32_t a = static_cast<uint32_t>(key >> 32), b = static_cast<uint32_t>(key);
        uint32_t index = world.pairs.Find(a, b);
        if (index == PairStore::kNone) added[count++] = index = AddPair(world, a, b);
        if (world.pairs.active.Insert(index)) world.activated.push_back(index);
    }
    world.jobs->ParallelFor(count, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) DescribePair(world, added[i]);
    });
}

}  // namespace

bool CanCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = world.bodies.dynamics[bodyA];
    const BodyDynamics& b = world.bodies.dynamics[bodyB];
    if (bodyA == bodyB) return false;
    if (a.motion != MotionType::Dynamic && b.motion != MotionType::Dynamic) return false;
    if (!(world.settings.layerCollides[a.layer] >> b.layer & 1u)) return false;
    if ((a.filtered || b.filtered) && !FiltersAllow(world, bodyA, bodyB)) return false;
    return !world.joints.ForbidsContact(bodyA, bodyB);
}

bool MayCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = world.bodies.dynamics[bodyA];
    const BodyDynamics& b = world.bodies.dynamics[bodyB];
    if ((a.dispersing && b.motion == MotionType::Dynamic) || (b.dispersing && a.motion == MotionType::Dynamic))
        return false;
    return (a.awake || b.awake) && CanCollide(world, bodyA, bodyB);
}

PairMaterial MaterialOfPair(const WorldState& world, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB,
                            uint8_t material) {
    const Material& a = world.bodies.cold[bodyA].material;
    const Material& b = world.bodies.cold[bodyB].material;
    float friction = b.friction, restitution = b.restitution;
    if (shapeB.IsSurface()) {
        const std::span<const SurfaceMaterial> palette = static_cast<const SurfaceShape&>(shapeB).Materials();
        if (material < palette.size()) {
            friction = palette[material].friction;
            restitution = palette[material].restitution;
        }
    }
    return {Combine(std::max(a.frictionRule, b.frictionRule), a.friction, friction),
            Combine(std::max(a.restitutionRule, b.restitutionRule), a.restitution, restitution)};
}

void CombineMaterials(WorldState& world, uint32_t index) {
    const Pair& pair = world.pairs.pairs[index];
    const PairMaterial material = MaterialOfPair(world, pair.bodyA, pair.bodyB, *pair.shapeB, pair.material);
    world.pairs.records[index].friction = material.friction;
    world.pairs.records[index].restitution = material.restitution;
}

void FindPairs(WorldState& world) {
    world.activated.clear();
    EndDispersing(world);
    if (!world.deepOverlaps.empty()) StartDispersing(world, world.deepOverlaps);
    world.deepOverlaps.clear();
    if (world.colliders.moved.empty()) return;
    SearchAll(world, kMostDeepPairs);
    if (FoundTooDeep(world, kMostDeepPairs)) {
        DisperseMoved(world);
        SearchAll(world, kAnyNumber);
        FoundTooDeep(world, kAnyNumber);
    }
    std::vector<uint64_t>& found = world.newPairs;
    found.clear();
    for (WorkerFindings& findings : world.findings) {
        found.insert(found.end(), findings.pairs.begin(), findings.pairs.end());
        findings.pairs.clear();
    }
    std::sort(found.begin(), found.end());
    ActivatePairs(world, found);
    ForgetMoved(world);
}

}  // namespace fulcrum
