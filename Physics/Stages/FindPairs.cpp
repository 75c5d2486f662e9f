// Pairs are found by whoever moved. Workers collect keys, which are sorted before any pair is made: the order of the pairs
// depends on ids alone, not on threads nor on the shape of the trees.
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

bool MayCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = world.bodies.dynamics[bodyA];
    const BodyDynamics& b = world.bodies.dynamics[bodyB];
    if (bodyA == bodyB) return false;
    if (a.motion != MotionType::Dynamic && b.motion != MotionType::Dynamic) return false;
    if (!(world.settings.layerCollides[a.layer] >> b.layer & 1u)) return false;
    return a.awake || b.awake;
}

void Search(const WorldState& world, uint32_t index, std::vector<uint64_t>& found) {
    const ColliderStore& store = world.colliders;
    const Collider& self = store.colliders[index];
    const auto visit = [&](uint32_t other) {
        const Collider& collider = store.colliders[other];
        if (collider.queued && other < index) return;  // it reports the pair itself
        if (!MayCollide(world, self.body, collider.body)) return;
        const uint32_t pair = world.pairs.Find(index, other);
        if (pair != PairStore::kNone && world.pairs.pairs[pair].activePlace != PairStore::kNone) return;
        found.push_back(index < other ? uint64_t(index) << 32 | other : uint64_t(other) << 32 | index);
    };
    const uint32_t layers = world.settings.layerCollides[world.bodies.dynamics[self.body].layer];
    if (layers & store.movingLayers) store.movingTree.Query(self.fat, visit);
    if (self.moving && (layers & store.fixedLayers)) store.fixedTree.Query(self.fat, visit);
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

void MakePair(WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    const auto bodyOf = [&](uint32_t collider) { return world.colliders.colliders[collider].body; };
    if (world.bodies.dynamics[bodyOf(colliderA)].motion != MotionType::Dynamic) std::swap(colliderA, colliderB);
    const uint32_t index = world.pairs.Add(colliderA, colliderB);
    Pair& pair = world.pairs.pairs[index];
    pair.bodyA = bodyOf(colliderA);
    pair.bodyB = bodyOf(colliderB);
    pair.fixedB = world.bodies.dynamics[pair.bodyB].motion != MotionType::Dynamic;
    pair.offset = world.colliders.colliders[colliderA].offset || world.colliders.colliders[colliderB].offset;
    CombineMaterials(world, index);
    world.pairs.Activate(index);
}

}  // namespace

void CombineMaterials(WorldState& world, uint32_t index) {
    const Pair& pair = world.pairs.pairs[index];
    const Material& a = world.bodies.cold[pair.bodyA].material;
    const Material& b = world.bodies.cold[pair.bodyB].material;
    ContactRecord& record = world.pairs.records[index];
    record.friction = Combine(std::max(a.frictionRule, b.frictionRule), a.friction, b.friction);
    record.restitution = Combine(std::max(a.restitutionRule, b.restitutionRule), a.restitution, b.restitution);
}

void FindPairs(WorldState& world) {
    std::vector<uint32_t>& moved = world.colliders.moved;
    if (moved.empty()) return;
    world.jobs->ParallelFor(static_cast<uint32_t>(moved.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) Search(world, moved[i], world.findings[range.worker].pairs);
    });
    std::vector<uint64_t>& found = world.newPairs;
    found.clear();
    for (WorkerFindings& findings : world.findings) {
        found.insert(found.end(), findings.pairs.begin(), findings.pairs.end());
        findings.pairs.clear();
    }
    std::sort(found.begin(), found.end());
    for (uint64_t key : found) {
        const uint32_t a = static_cast<uint32_t>(key >> 32), b = static_cast<uint32_t>(key);
        const uint32_t resting = world.pairs.Find(a, b);
        if (resting == PairStore::kNone) MakePair(world, a, b);
        else world.pairs.Activate(resting);
    }
    for (uint32_t collider : moved) world.colliders.colliders[collider].queued = false;
    moved.clear();
}

}  // namespace fulcrum
