// Dynamic bodies on ground that an edit raised: they move up with it at once, since contacts would push out those whose
// centers are above it alone, and slowly. Along the up axis of the field, without change of velocity. Between steps,
// under the world's lock; one thread.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <cstdint>
#include <span>

namespace fulcrum {

struct WorldState;

// Memory for it; all zero and empty between edits.
struct LiftStore {
    enum class Mechanism : uint8_t { Unknown, Free, Held };
    struct Body {
        float lift = 0, spread = 0;  // m; that which others have followed
        Mechanism mechanism = Mechanism::Unknown;
        bool isListed = false;  // in `listed`
    };
    Array<Body> bodies;  // by index
    Array<uint32_t> listed, mechanism;
};
size_t HeapBytes(const LiftStore& store);

// So that the next lifts ask for no memory.
void ReserveLifts(WorldState& world);
// Lifts what the edit with a version, of the field that is the shape of a collider, would leave in the ground:
//  - of `near`, indices of bodies in ascending order, those with a piece whose center was above the ground before: by
//    the rise below its center, less the gap there was;
//  - what lies on a body that is lifted, and what joints connect with it, with it.
// Mechanisms that a joint holds at a point of what does not move stay where they are.
void LiftByEdit(WorldState& world, uint32_t collider, uint64_t version, std::span<const uint32_t> near);

}  // namespace fulcrum
