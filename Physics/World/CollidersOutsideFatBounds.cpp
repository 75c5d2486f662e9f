#include <Fulcrum/Physics/World/CollidersOutsideFatBounds.h>

#include <Fulcrum/Physics/World/FatBounds.h>

namespace fulcrum {

void CollidersOutsideFatBounds::Forget(uint32_t collider) {
    if (tree_.Contains(collider)) tree_.Remove(collider);
}

void CollidersOutsideFatBounds::Clear() {
    if (tree_.Size() > 0) tree_.Clear();
    isFresh_.store(true, std::memory_order_relaxed);
}

void CollidersOutsideFatBounds::Refresh(const BodyStore& bodies, const ColliderStore& colliders) {
    if (isFresh_.load(std::memory_order_acquire)) return;
    const std::lock_guard<std::mutex> guard(refreshing_);
    if (isFresh_.load(std::memory_order_relaxed)) return;
    tree_.Clear();
    // Sleeping bodies were refitted when they fell asleep.
    for (const uint32_t body : bodies.awake) {
        VisitColliders(bodies, colliders, body, [&](uint32_t i) {
            const Bounds bounds = TightBoundsOf(bodies, colliders, i);
            if (!colliders.colliders[i].fat.Contains(bounds)) tree_.Insert(i, bounds);
        });
    }
    if (tree_.Size() > 8) tree_.Rebuild();
    isFresh_.store(true, std::memory_order_release);
}

}  // namespace fulcrum
