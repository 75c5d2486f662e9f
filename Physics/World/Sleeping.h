// Islands are sets of dynamic bodies connected by contacts and joints: they fall asleep together. One thread.
#pragma once

#include <Fulcrum/Physics/World/Waking.h>

#include <span>

namespace fulcrum {

// Finds the island of each awake body, as the index of its first one in BodyStore::awake. `roots` must have one element
// per awake body.
void FindAwakeIslands(const BodyStore& bodies, const PairStore& pairs, const ConstraintColoring& coloring,
                      std::span<uint32_t> roots);
// Puts the bodies, all awake, to sleep as one island, and refits fat bounds that do not contain them. Must be followed
// by RestPairs.
void PutToSleep(const SleepStores& stores, CollidersOutsideFatBounds& outsideFatBounds,
                std::span<const uint32_t> bodies);
// Deactivates pairs without an awake body, until one of their bodies wakes.
void RestPairs(const BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring);
// The bodies of the island of an awake body, for SleepAsIsland, which then puts them to sleep, slow or not, and asks
// for no memory.
Array<uint32_t> IslandToSleep(WorldState& world, uint32_t body);
void SleepAsIsland(WorldState& world, std::span<const uint32_t> bodies);

}  // namespace fulcrum
