// The pairs of whole bodies. Called by BodyInterface between steps, and as a step begins; one thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>
#include <span>
#include <vector>

namespace fulcrum {

// Calls visit(pair) for each pair of the bodies' colliders, further manifolds left out, in ascending order whatever the
// order in which the colliders' lists have them. The visitor may remove the pair it is called with.
template <class Visitor>
void VisitPairsOf(const WorldState& world, std::span<const uint32_t> bodies, Visitor&& visit) {
    std::vector<uint32_t> pairs;
    for (uint32_t body : bodies)
        VisitColliders(world, body, [&](uint32_t collider) {
            world.pairs.VisitOf(collider, [&](uint32_t pair) { pairs.push_back(pair); });
        });
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());  // a pair of two of the bodies is in two lists
    for (uint32_t pair : pairs) visit(pair);
}

}  // namespace fulcrum
