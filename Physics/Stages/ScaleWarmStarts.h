// Applies the warm start of a substep to the velocities of islands with joints, scaled such that it never adds what an
// exact solution would take away: see WarmStart.h. Called by Solve; one thread per group of islands.
#pragma once

#include <Fulcrum/Constraints/WarmStart.h>
#include <Fulcrum/Physics/World/BodyStore.h>

#include <span>

namespace fulcrum {

// Sums over an island.
struct IslandWarmStart {
    double slope = 0, curvature = 0;  // v . p + b lambda, p . M^-1 p + gamma lambda^2
    float scale = 0;
};

// bodies: sorted; islandOf: for each, its place in `islands`, which has as many elements and is overwritten. starts: by
// body of the world; receives the scales. Returns whether some scale is less than one.
bool ScaleWarmStarts(BodyStore& store, std::span<const uint32_t> bodies, const uint32_t* islandOf, WarmStart* starts,
                     std::span<IslandWarmStart> islands);

}  // namespace fulcrum
