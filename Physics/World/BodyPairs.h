// The pairs of whole bodies. Called by BodyInterface between steps, and as a step begins; one thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>
#include <span>
#include <vector>

namespace fulcrum {

// Calls visit(pair) for each pair of these bodies' colliders, further manifolds left out, in ascending order whatever
// the order in which the colliders' lists have them. The visitor may remove the pair it is called with.
template <class Visitor>
void VisitPairsOf(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                  std::span<const uint32_t> of, Visitor&& visit) {
    std::vector<uint32_t> found;
    for (uint32_t body : of)
        VisitColliders(bodies, colliders, body, [&](uint32_t collider) {
            pairs.VisitOf(collider, [&](uint32_t pair) { found.push_back(pair); });
        });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());  // a pair of two of the bodies is in two lists
    for (uint32_t pair : found) visit(pair);
}

}  // namespace fulcrum
