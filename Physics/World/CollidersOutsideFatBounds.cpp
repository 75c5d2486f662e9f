#include <Fulcrum/Physics/World/CollidersOutsideFatBounds.h>

#include <Fulcrum/Physics/World/FatBounds.h>

namespace fulcrum {

void CollidersOutsideFatBounds::Forget(uint32_t collider) {
    if (tree_.Contains(collider)) tree_.Remove(collider);
}

void CollidersOutsideFatBounds::Refresh(const WorldState& world) {
    if (isFresh_.load(std::memory_order_acquire)) return;
    const std::lock_guard<std::mutex> guard(refreshing_);
    if (isFresh_.load(std::memory_order_relaxed)) return;
    tree_.Clear();
    // Those that fell asleep were refitted then.
    for (const uint32_t body : world.bodies.awake) {
        VisitColliders(world, body, [&](uint32_t i) {
            const Bounds bounds = TightBoundsOf(world, i);
            if (!world.colliders.colliders[i].fat.Contains(bounds)) tree_.Insert(i, bounds);
        });
    }
    if (tree_.Size() > 8) tree_.Rebuild();
    isFresh_.store(true, std::memory_order_release);
}

}  // namespace fulcrum
