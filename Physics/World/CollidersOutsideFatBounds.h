// Colliders that are out of their fat bounds, since the last step moved them or an edit changed their shape. The trees
// are only updated at the start of the next step, so queries test these in addition. Computed by the first query after
// a step or an edit, so that worlds without queries pay nothing; does not influence steps. Refresh may be called by
// many readers at once, everything else by the one writer.
#pragma once

#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <atomic>
#include <mutex>

namespace fulcrum {

class BodyStore;
class ColliderStore;

class CollidersOutsideFatBounds {
public:
    void MarkStale() { state_.store(State::Stale, std::memory_order_relaxed); }  // after a step
    void Forget(uint32_t collider);  // it was removed, or its bounds were updated
    void Clear();                    // in a step: all fat bounds contain their colliders
    void Refresh(const BodyStore& bodies, const ColliderStore& colliders);  // before a query

    bool IsEmpty() const { return tree_.Size() == 0; }
    bool Contains(uint32_t collider) const { return tree_.Contains(collider); }
    const BoundsTree& Tree() const { return tree_; }
    size_t MemoryUsed() const { return tree_.MemoryUsed(); }

private:
    enum class State : uint8_t { Stale, Fresh, InStep };
    bool IsFresh(const BodyStore& bodies);

    std::atomic<State> state_{State::Fresh};
    std::atomic<uint64_t> shapeVersion_{0};  // edits up to this one have been looked at
    std::mutex refreshing_;
    BoundsTree tree_;
};

}  // namespace fulcrum
