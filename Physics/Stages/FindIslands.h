// Islands and the solver's groups of them, and helpers shared by the parts of BuildIslands.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/SavedEfforts.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/Stages/StepContext.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

#include <algorithm>
#include <span>

namespace fulcrum {

struct Islands {
    std::span<uint32_t> groupOf;  // by index in bodies.awake: the group, or kNone without constraints
    std::span<uint32_t> rootOf;   // likewise: the least index of its island
    uint32_t groups = 0;
    uint32_t islands = 0;
    static constexpr uint32_t kNone = ~0u;
    static constexpr uint32_t kLargeGroup = 0;  // see SolverGroup
};

// Finds islands, and fills the layout's groups, without their bodies and colors, its efforts, and the patterns of
// islands that are solved directly. Uses scratch memory of the step. saved: restored efforts, or null.
Islands FindIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                    const JointStore& joints, const PairStore& pairs, const Array<SavedEffort>* saved,
                    SolverLayout& layout, ScratchArena& scratch);

// m/s: after a fall of 0.13 s. What falls or is thrown is no load yet, and its impacts take long.
inline float CalmSpeed(const SystemSettings& settings) { return 0.13f * std::max(Length(settings.gravity), 1.0f); }

// Calls visit(color, entry) for all constraints of a kind, those without a color last.
template <class Visit>
void VisitEntries(const ConstraintColoring& coloring, ConstraintColoring::Kind kind, Visit&& visit) {
    for (uint32_t c = 0; c <= ConstraintColoring::kColors; ++c)
        for (const ConstraintColoring::Entry& entry : coloring.At(static_cast<int>(c)).Of(kind)) visit(c, entry);
}

inline uint32_t MovingBodyOf(const ConstraintColoring::Entry& entry) {
    return entry.fixedA ? entry.bodyB : entry.bodyA;
}

inline uint32_t GroupOf(const BodyStore& bodies, const Islands& islands, const ConstraintColoring::Entry& entry) {
    return islands.groupOf[bodies.cold[MovingBodyOf(entry)].awakePlace];
}

// Replaces each count by the sum of those before it; returns the total.
inline uint32_t ExclusivePrefixSum(std::span<uint32_t> counts) {
    uint32_t sum = 0;
    for (uint32_t& count : counts) {
        const uint32_t n = count;
        count = sum;
        sum += n;
    }
    return sum;
}

}  // namespace fulcrum
