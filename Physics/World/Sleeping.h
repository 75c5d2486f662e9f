// Islands are sets of dynamic bodies that touch one another or are joined: they fall asleep together. One thread.
#pragma once

#include <Fulcrum/Physics/World/Waking.h>

#include <span>

namespace fulcrum {

// Finds the island of each awake body, as the place of its first one in BodyStore::awake. `roots` is room for as many
// as are awake.
void FindAwakeIslands(const BodyStore& bodies, const PairStore& pairs, const ConstraintColoring& coloring,
                      std::span<uint32_t> roots);
// Makes the bodies, all awake, one sleeping island. RestPairs is to follow. Their fat bounds are made to hold them.
void PutToSleep(const SleepStores& stores, CollidersOutsideFatBounds& outsideFatBounds,
                std::span<const uint32_t> bodies);
// Pairs without an awake body rest until one of their bodies wakes.
void RestPairs(const BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring);
// Puts the island of an awake body to sleep, slow or not.
void SleepIslandOf(WorldState& world, uint32_t body);

}  // namespace fulcrum
