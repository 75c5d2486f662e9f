// Pairs are found by whoever moved. Workers collect keys, which are sorted before any pair is made: the order of the pairs
// depends on ids alone, not on threads nor on the shape of the trees. Pairs that exist are recognised by their bounds, most
// of the time: the table of pairs is asked about new ones only.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Physics/Stages/Crowd.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// A collider that stands in more others than this has pairs with so many alone, the nearest, and with those whose nearest it is. Others
// follow when these are apart: thousands at one point would make millions of pairs, and be pushed no better.
constexpr size_t kMostDeep = 16;
// New pairs of such bodies, from which on that is done.
constexpr uint32_t kCrowd = 1024;

// Whether the bounds of two colliders, of which the first has moved, ask for a pair that is not active.
bool AskForPair(const WorldState& world, uint32_t index, uint32_t other) {
    const Collider &self = world.colliders.colliders[index], &collider = world.colliders.colliders[other];
    if (collider.previous.Overlaps(self.previous)) return false;  // they have their pair, or may not have one
    if (!MayCollide(world, self.body, collider.body)) return false;
    const uint32_t pair = world.pairs.Find(index, other);
    return pair == PairStore::kNone ? ListenerAllows(world, self.body, collider.body) : !world.pairs.active.Contains(pair);
}

uint64_t KeyOf(uint32_t a, uint32_t b) { return a < b ? uint64_t(a) << 32 | b : uint64_t(b) << 32 | a; }

// Notes their pair if it is to be.
void Consider(const WorldState& world, uint32_t index, uint32_t other, WorkerFindings& findings) {
    if (findings.deepPairs > kCrowd || !AskForPair(world, index, other)) return;  // in a crowd all will be searched again
    findings.deepPairs += Nearness(CrowdPlaceOf(world, index), CrowdPlaceOf(world, other)) < kDeepNearness;
    findings.pairs.push_back(KeyOf(index, other));
}

// Calls visit(other) for what the bounds of a collider meet.
template <class Visit>
void VisitNeighbors(const WorldState& world, uint32_t index, const Visit& visit) {
    const ColliderStore& store = world.colliders;
    const Collider& self = store.colliders[index];
    if (self.sensor) return;
    const uint32_t layers = world.settings.layerCollides[world.bodies.dynamics[self.body].layer];
    if (layers & store.movingLayers) store.movingTree.Query(self.fat, visit);
    if (self.moving && (layers & store.fixedLayers)) store.fixedTree.Query(self.fat, visit);
}

// What one collider meets.
void Search(const WorldState& world, uint32_t index, WorkerFindings& findings) {
    VisitNeighbors(world, index, [&](uint32_t other) {
        if (world.colliders.colliders[other].queued && other < index) return;  // it reports the pair itself
        Consider(world, index, other, findings);
    });
}

// The same in a crowd. What is dynamic and searches, too, has the other among its nearest or not: either may ask for the pair.
void SearchInCrowd(const WorldState& world, uint32_t index, std::span<const CrowdPlace> places, WorkerFindings& findings) {
    std::vector<std::pair<float, uint32_t>>& near = findings.near;
    near.clear();
    // Also those that exist, so that the others are known from them.
    const auto ask = [&](uint32_t other) {
        const uint32_t pair = world.pairs.Find(index, other);
        const bool isActive = pair != PairStore::kNone && world.pairs.active.Contains(pair);
        if (isActive || AskForPair(world, index, other)) findings.pairs.push_back(KeyOf(index, other));
    };
    size_t deep = 0;
    VisitNeighbors(world, index, [&](uint32_t other) {
        if (!world.colliders.colliders[other].queued) return ask(other);
        const float nearness = Nearness(places[index], places[other]);
        near.push_back({nearness, other});
        deep += nearness < kDeepNearness;
    });
    if (deep > kMostDeep) {
        const uint32_t body = world.colliders.colliders[index].body;
        std::erase_if(near, [&](const auto& other) {
            return !std::isinf(other.first) && !MayCollide(world, body, world.colliders.colliders[other.second].body);
        });
        // What cannot be pushed is not among the nearest, nor may it be left out.
        const auto pushed = std::partition(near.begin(), near.end(), [](const auto& other) { return std::isinf(other.first); });
        if (near.end() - pushed > static_cast<ptrdiff_t>(kMostDeep)) {
            std::nth_element(pushed, pushed + kMostDeep, near.end());
            near.erase(pushed + kMostDeep, near.end());
            findings.crowded.push_back(index);
        }
    }
    for (const auto& [nearness, other] : near) ask(other);
}

void SearchEach(WorldState& world) {
    const std::vector<uint32_t>& moved = world.colliders.moved;
    world.jobs->ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) Search(world, moved[i], world.findings[range.worker]);
    });
}

// The same where most have moved: what moves meets what moves, neighbours with neighbours.
void SearchTogether(WorldState& world) {
    const ColliderStore& store = world.colliders;
    const auto isQueued = [&](uint32_t i) { return store.colliders[i].queued; };
    world.jobs->ParallelFor(store.movingTree.NodeCount(), 8, [&](JobRange range) {
        WorkerFindings& found = world.findings[range.worker];
        store.movingTree.VisitPairs(range.begin, range.end, [&](uint32_t a, uint32_t b) {
            const uint32_t low = std::min(a, b), high = std::max(a, b);
            if (isQueued(low)) Consider(world, low, high, found);
            else if (isQueued(high)) Consider(world, high, low, found);
        });
        store.movingTree.VisitGroups(range.begin, range.end, [&](const Bounds& all, std::span<const uint32_t> ids) {
            bool meets = false;
            store.fixedTree.Query(all, [&](uint32_t) { meets = true; });
            if (!meets) return;
            for (uint32_t index : ids) {
                if (!isQueued(index)) continue;
                store.fixedTree.Query(store.colliders[index].fat, [&](uint32_t other) {
                    if (!isQueued(other) || index < other) Consider(world, index, other, found);
                });
            }
        });
    });
    world.jobs->ParallelFor(static_cast<uint32_t>(store.moved.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            if (!store.colliders[store.moved[i]].moving) Search(world, store.moved[i], world.findings[range.worker]);
    });
}

// Whether so many stand in one another that each is to push its nearest alone; then what was found is forgotten.
bool IsCrowded(WorldState& world) {
    uint64_t deep = 0;
    for (WorkerFindings& findings : world.findings) {
        deep += findings.deepPairs;
        findings.deepPairs = 0;
    }
    if (deep <= kCrowd) return false;
    for (WorkerFindings& findings : world.findings) findings.pairs.clear();
    return true;
}

void SearchAllInCrowd(WorldState& world) {
    const std::vector<uint32_t>& moved = world.colliders.moved;
    const std::span<CrowdPlace> places = world.scratch.Allocate<CrowdPlace>(world.colliders.colliders.size());
    for (const uint32_t index : moved) places[index] = CrowdPlaceOf(world, index);
    world.jobs->ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) SearchInCrowd(world, moved[i], places, world.findings[range.worker]);
    });
}

// Two that both have enough nearer ones lose the pair that they have from when these were farther away. `found`: all that are to be.
void RemoveFarPairs(WorldState& world, std::span<const uint64_t> found) {
    const std::span<uint8_t> isCrowded = world.scratch.Allocate<uint8_t>(world.colliders.colliders.size());
    std::fill(isCrowded.begin(), isCrowded.end(), uint8_t(0));
    for (const WorkerFindings& findings : world.findings)
        for (const uint32_t index : findings.crowded) isCrowded[index] = 1;
    std::vector<uint32_t> far;
    for (const WorkerFindings& findings : world.findings)
        for (const uint32_t index : findings.crowded)
            world.pairs.VisitOf(index, [&](uint32_t pair) {
                const uint32_t a = world.pairs.pairs[pair].colliderA, b = world.pairs.pairs[pair].colliderB;
                if (a != index || !isCrowded[b] || std::binary_search(found.begin(), found.end(), KeyOf(a, b))) return;
                far.push_back(pair);
            });
    std::sort(far.begin(), far.end());
    for (const uint32_t pair : far) {
        if (pair < world.changes.size()) world.changes[pair] = PairChange::None;
        RemovePair(world, pair);
    }
}

// Who has not got all pairs searches again in the next step, whatever it knows from this one.
void RequeueCrowded(WorldState& world) {
    for (WorkerFindings& findings : world.findings) {
        for (uint32_t index : findings.crowded) {
            world.colliders.colliders[index].previous = {};
            world.colliders.Queue(index);
        }
        findings.crowded.clear();
    }
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
    return (world.bodies.dynamics[bodyA].awake || world.bodies.dynamics[bodyB].awake) && CanCollide(world, bodyA, bodyB);
}

PairMaterial MaterialOfPair(const WorldState& world, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB, uint8_t material) {
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
    if (world.colliders.moved.empty()) return;
    if (world.colliders.MostMoved()) SearchTogether(world);
    else SearchEach(world);
    const bool isCrowded = IsCrowded(world);
    if (isCrowded) SearchAllInCrowd(world);
    std::vector<uint64_t>& found = world.newPairs;
    found.clear();
    for (WorkerFindings& findings : world.findings) {
        found.insert(found.end(), findings.pairs.begin(), findings.pairs.end());
        findings.pairs.clear();
    }
    std::sort(found.begin(), found.end());
    if (isCrowded) {
        found.erase(std::unique(found.begin(), found.end()), found.end());  // both may have found a pair
        RemoveFarPairs(world, found);
    }
    ActivatePairs(world, found);
    ForgetMoved(world);
    if (isCrowded) RequeueCrowded(world);
}

}  // namespace fulcrum
