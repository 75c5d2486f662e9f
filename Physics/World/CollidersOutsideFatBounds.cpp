#include <Fulcrum/Physics/World/CollidersOutsideFatBounds.h>

#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/ShapeEdits.h>

namespace fulcrum {

void CollidersOutsideFatBounds::Forget(uint32_t collider) {
    if (tree_.Contains(collider)) tree_.Remove(collider);
}

void CollidersOutsideFatBounds::Clear() {
    if (tree_.Size() > 0) tree_.Clear();
    state_.store(State::InStep, std::memory_order_relaxed);
}

// In a step there are no edits. Edits of shapes that only other worlds have may come at any time: readers may be in the
// tree then, which is left alone.
bool CollidersOutsideFatBounds::IsFresh(const BodyStore& bodies) {
    const State state = state_.load(std::memory_order_acquire);
    if (state == State::InStep) return true;
    const uint64_t latest = LatestShapeVersion(), seen = shapeVersion_.load(std::memory_order_acquire);
    if (state == State::Stale) return false;
    if (latest == seen) return true;
    if (AreShapesEditedSince(bodies, seen)) return false;
    shapeVersion_.store(latest, std::memory_order_relaxed);
    return true;
}

void CollidersOutsideFatBounds::Refresh(const BodyStore& bodies, const ColliderStore& colliders) {
    if (IsFresh(bodies)) return;
    const std::lock_guard<std::mutex> guard(refreshing_);
    if (IsFresh(bodies)) return;
    const uint64_t latest = LatestShapeVersion();
    tree_.Clear();
    // Sleeping bodies were refitted when they fell asleep.
    const auto look = [&](uint32_t body) {
        VisitColliders(bodies, colliders, body, [&](uint32_t i) {
            const Bounds bounds = TightBoundsOf(bodies, colliders, i);
            if (!colliders.colliders[i].fat.Contains(bounds) && !tree_.Contains(i)) tree_.Insert(i, bounds);
        });
    };
    for (const uint32_t body : bodies.awake) look(body);
    bodies.editable.Visit([&](uint32_t body) {
        if (bodies.cold[body].exists) look(body);
    });
    if (tree_.Size() > 8) tree_.Rebuild();
    shapeVersion_.store(latest, std::memory_order_release);
    state_.store(State::Fresh, std::memory_order_release);
}

}  // namespace fulcrum
