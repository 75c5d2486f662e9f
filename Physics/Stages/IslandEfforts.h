// What islands are to be solved with where the system's settings do not do. Called by FindIslands.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/Stages/StepContext.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <span>

namespace fulcrum {

struct IslandEffort {
    LeastEffort least;
    bool isLoaded = false;   // loads of contacts ask for it
    uint8_t stiffness = 0;   // with which loaded contacts were solved; 0: they are new
    float longer = 1;        // its springs are to be those of substeps longer by this, see kLoadedSubstep
    uint32_t culprit = ~0u;  // the body of the joint or contact that asked for most of it
};

// Sets each number of an effort to that of the other where it is less; of stiffness the lesser one counts.
void Raise(IslandEffort& effort, const IslandEffort& to);

// Efforts by the root of the island, in `sets` by place in bodies.awake. Of each number the largest that joints of the
// island ask for; and what the loads of its contacts ask for, where it has at most `mostLoaded` constraints. sizes:
// constraints, by root.
std::span<const IslandEffort> FindEfforts(const StepContext& step, const BodyStore& bodies,
                                          const ConstraintColoring& coloring, const JointStore& joints,
                                          const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded,
                                          UnionFind& sets, ScratchArena& scratch);

}  // namespace fulcrum
