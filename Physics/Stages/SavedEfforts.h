// Which efforts BuildIslands chose, as snapshots have them. It chooses only where constraints or loads change, by where
// bodies are then: efforts are state. Groups and batches are not, and are made anew from this after a snapshot was
// restored. Written by snapshots and taken by the next BuildIslands. One thread.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/PairStore.h>

#include <vector>

namespace fulcrum {

// A group with an effort of its own, which is that of one island.
struct SavedEffort {
    uint32_t body = ~0u;  // its lowest one; ~0u: the first group, of large islands
    uint32_t culprit = ~0u;
    LeastEffort effort{};
    uint8_t stiffness = 0, wantedStiffness = 0;  // as SolverGroup has them
};

// A contact of a group with substeps of its own, and with how many it was solved.
struct SolvedContact {
    uint32_t contact;
    int substeps;
};

struct SavedEfforts {
    bool areRestored = false;             // the next BuildIslands is to take them
    bool areCurrent = false;              // nothing has changed since they were chosen
    std::vector<SavedEffort> groups;      // ascending by body; empty where they are not current
    std::vector<SolvedContact> contacts;  // ascending
    // Restored ones hold as long as these stay: ConstraintColoring's and PairStore's.
    uint64_t version = 0, loadVersion = 0;

    bool AreTaken(const ConstraintColoring& coloring, const PairStore& pairs) const {
        return areRestored && areCurrent && version == coloring.Version() && loadVersion == pairs.loadVersion;
    }
};

inline size_t HeapBytes(const SavedEfforts& saved) {
    const auto& [areRestored, areCurrent, groups, contacts, version, loadVersion] = saved;
    return HeapBytes(groups, contacts);
}

// Those of a layout, or those that were restored and wait to be taken.
void DescribeEfforts(const SolverLayout& layout, const ConstraintColoring& coloring, const PairStore& pairs,
                     const SavedEfforts& restored, SavedEfforts& described);

}  // namespace fulcrum
