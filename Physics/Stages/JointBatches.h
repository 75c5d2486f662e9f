// The joints of the solver's groups, cut into batches of lanes. Called by BuildIslands.
#pragma once

#include <Fulcrum/Physics/Stages/FindIslands.h>

namespace fulcrum {

// A joint with its place: group * ConstraintColoring::kColors + color.
struct SortedJoint {
    uint32_t place, kind, joint;
};

// All colored joints but those that overflow, by place. Where joints came or went, or their types changed, it first
// brings what `joints` and `layout` know of the types up to date. In scratch memory of the step.
std::span<const SortedJoint> SortJoints(const BodyStore& bodies, const ConstraintColoring& coloring,
                                        const Islands& islands, JointStore& joints, SolverLayout& layout,
                                        ScratchArena& scratch);

// Cuts the joints of one color into batches, from the front of `sorted`. Trees know the parts of JointBatch alone.
void MakeJointBatches(const BodyStore& bodies, const JointStore& joints, uint32_t place, bool hasTrees,
                      std::span<const SortedJoint>& sorted, SolverLayout& layout, ColorBatches& color);

// Of those that fitted no color, one by one.
void MakeOverflowJoints(const BodyStore& bodies, const JointStore& joints, const ConstraintColoring& coloring,
                        std::vector<JointBatch<1>>& batches);

// Gives every batch its room for rows.
void ShareRows(SolverLayout& layout);

}  // namespace fulcrum
