// Finds the mechanisms whose joints iterations resolve poorly, which are solved directly (Constraints/Direct) where
// that costs little: those that carry much more than their own bodies' mass, those with closed loops, those of which
// a motor with a target speed drives a joint at its stops, and those with a joint that has been strained, past its
// limits (JointStrain.h) or beyond its target (ContactLoads.h). Called by the BuildIslands stage if joints were added
// or removed, got such a motor, or began to be so. Serial; the result depends only on the joints.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/JointStore.h>

namespace fulcrum {

struct HardMechanisms {
    // One dynamic body of each: of those that are hard whatever touches them, and of those with joints that may
    // contradict each other, by loops or limits.
    Array<uint32_t> open, contradicting;
    uint64_t version = 0, strainVersion = 0;  // versions of the joints from which this was computed
};
inline size_t HeapBytes(const HardMechanisms& all) {
    const auto& [open, contradicting, version, strainVersion] = all;
    return HeapBytes(open, contradicting, version, strainVersion);
}

// Updates `found` from the colored joints. Reads the settings' exactJointLoad and solver.
void FindHardMechanisms(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                        const SystemSettings& settings, HardMechanisms& found, ScratchArena& scratch);

}  // namespace fulcrum
