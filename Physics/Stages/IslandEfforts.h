// Which islands need more than the system's settings, and how large ones get it. Called by FindIslands.
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
    bool isHard = false;     // contacts sink by more than they may with the settings' effort
    uint32_t culprit = ~0u;  // the body of the joint or contact that asked for most of it
};

// Component-wise maximum of both efforts.
void Raise(IslandEffort& effort, const IslandEffort& to);

// Efforts by the root of the island; `sets` is indexed as bodies.awake. Each number is the maximum that joints of the
// island require; large islands, of more than `mostLoaded` constraints, get more that are walls or of small bodies.
// sizes: number of constraints, by root.
std::span<const IslandEffort> FindEfforts(const StepContext& step, const BodyStore& bodies,
                                          const ConstraintColoring& coloring, const JointStore& joints,
                                          const PairStore& pairs, std::span<const uint32_t> sizes, uint32_t mostLoaded,
                                          UnionFind& sets, ScratchArena& scratch);

}  // namespace fulcrum
