// What islands are to be solved with where the system's settings do not do. Called by FindIslands.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <span>

namespace fulcrum {

struct IslandEffort {
    uint8_t substeps = 0, velocityIterations = 0, positionIterations = 0;  // 0: the system's
    bool isLoaded = false;                                                 // loads of contacts ask for it
    uint8_t stiffness = 0;  // with which loaded contacts were solved; 0: they are new
    bool IsUsual() const { return substeps == 0 && velocityIterations == 0 && positionIterations == 0; }
};

// Sets each number of an effort to that of the other where it is less; of stiffness the lesser one counts.
void Raise(IslandEffort& effort, const IslandEffort& to);

// Efforts by the root of the island, in `sets` by place in bodies.awake. Of each number the largest that joints of the
// island ask for; and what the loads of its contacts ask for, where it has at most `mostLoaded` constraints. sizes:
// constraints, by root. softness: s^2, see SoftnessOf.
std::span<const IslandEffort> FindEfforts(const BodyStore& bodies, const ConstraintColoring& coloring,
                                          const JointStore& joints, const PairStore& pairs,
                                          const SystemSettings& settings, std::span<const uint32_t> sizes,
                                          uint32_t mostLoaded, float softness, UnionFind& sets, ScratchArena& scratch);

}  // namespace fulcrum
