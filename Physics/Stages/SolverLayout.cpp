#include <Fulcrum/Physics/Stages/SolverLayout.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const SolverLayout& layout) {
    const auto& [groups, efforts, waiting, colors, bodies, islandOf, balls, joints, moving, fixed, overflowJoints,
                 overflowMoving, overflowFixed, jointRows, overflowRows, listedJoints, rowJoints, jointVersion, hard,
                 patternWords, notes, colorCount, uncolored, islands, version, loadVersion] = layout;
    return HeapBytes(groups, efforts, waiting, colors, bodies, islandOf, balls, joints, moving, fixed, overflowJoints,
                     overflowMoving, overflowFixed, jointRows, overflowRows, listedJoints, rowJoints, jointVersion,
                     hard, patternWords, colorCount, uncolored, islands, version, loadVersion);
}

}  // namespace fulcrum
