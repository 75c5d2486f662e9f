// Visits the pairs of whole bodies. Called by BodyInterface between steps, and at the start of a step; one thread.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>
#include <span>

namespace fulcrum {

// The pairs of these bodies' colliders, except additional manifolds, in ascending order, independent of the order of
// the colliders' lists.
inline Array<uint32_t> PairsOf(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                               std::span<const uint32_t> of) {
    Array<uint32_t> found;
    for (uint32_t body : of)
        VisitColliders(bodies, colliders, body, [&](uint32_t collider) {
            pairs.VisitOf(collider, [&](uint32_t pair) { found.push_back(pair); });
        });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()),
                found.end());  // pairs between two of the bodies are in two lists
    return found;
}
inline Array<uint32_t> PairsOf(const WorldState& world, uint32_t body) {
    return PairsOf(world.bodies, world.colliders, world.pairs, {&body, 1});
}

// Calls visit(pair) for each of them. The visitor may remove the pair it is called with.
template <class Visitor>
void VisitPairsOf(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                  std::span<const uint32_t> of, Visitor&& visit) {
    for (const uint32_t pair : PairsOf(bodies, colliders, pairs, of)) visit(pair);
}

}  // namespace fulcrum
