// The efforts chosen by BuildIslands, for snapshots. They are state, since they are chosen only when constraints or
// loads change, by the poses at that time. Groups and batches are derived and rebuilt from this after a snapshot was
// restored. Written by snapshots and taken by the next BuildIslands. One thread.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

// A group with an effort of its own, or one that is solved directly because of loads: that of one island.
struct SavedEffort {
    uint32_t body = ~0u;  // the island's lowest index; ~0u: the first group, of large islands
    uint32_t culprit = ~0u;
    LeastEffort effort{};
    bool isLoaded = false, isWaiting = false;  // see SolverGroup, IslandWithEffort
};

struct SavedEfforts {
    bool areRestored = false;   // the next BuildIslands takes them
    bool areCurrent = false;    // nothing has changed since they were chosen
    Array<SavedEffort> groups;  // ascending by body; empty if not current
    // Versions of ConstraintColoring and PairStore for which restored efforts are valid.
    uint64_t version = 0, loadVersion = 0;

    bool AreTaken(const ConstraintColoring& coloring, const PairStore& pairs) const {
        return areRestored && areCurrent && version == coloring.Version() && loadVersion == pairs.loadVersion;
    }
};

inline size_t HeapBytes(const SavedEfforts& saved) {
    const auto& [areRestored, areCurrent, groups, version, loadVersion] = saved;
    return HeapBytes(groups);
}

// The efforts of a layout, or those restored but not yet taken.
void DescribeEfforts(const SolverLayout& layout, const ConstraintColoring& coloring, const PairStore& pairs,
                     const SavedEfforts& restored, SavedEfforts& described);

}  // namespace fulcrum
