// Partitions the joints of the solver's groups into batches of lanes. Called by BuildIslands.
#pragma once

#include <Fulcrum/Physics/Stages/FindIslands.h>

namespace fulcrum {

// A joint with its sort key: group * ConstraintColoring::kColors + color.
struct SortedJoint {
    uint32_t place, kind, joint;
};

// All joints with a color, sorted by group and color, in scratch memory of the step. If joints were added or removed,
// or their types changed, first updates the data of the types in `joints` and `layout`.
std::span<const SortedJoint> SortJoints(const BodyStore& bodies, const ConstraintColoring& coloring,
                                        const Islands& islands, JointStore& joints, SolverLayout& layout,
                                        ScratchArena& scratch);

// Partitions the joints of one color, at the front of `sorted`, into batches. Those of groups that are solved directly
// are never in a BallBatch.
void MakeJointBatches(const BodyStore& bodies, const JointStore& joints, uint32_t place,
                      std::span<const SortedJoint>& sorted, SolverLayout& layout, ColorBatches& color);

// Batches of one lane for joints without a color.
void MakeOverflowJoints(const BodyStore& bodies, const JointStore& joints, const ConstraintColoring& coloring,
                        Array<JointBatch<1>>& batches);

// Assigns every batch its range of rows.
void ShareRows(SolverLayout& layout);

}  // namespace fulcrum
