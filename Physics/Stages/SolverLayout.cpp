#include <Fulcrum/Physics/Stages/SolverLayout.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const SolverLayout& layout) {
    const auto& [groups, colors, bodies, balls, joints, moving, fixed, overflowJoints, overflowMoving, overflowFixed,
                 jointRows, overflowRows, listedJoints, jointVersion, trees, treesByGroup, notes, colorCount, islands,
                 version, loadVersion] = layout;
    return HeapBytes(groups, colors, bodies, balls, joints, moving, fixed, overflowJoints, overflowMoving,
                     overflowFixed, jointRows, overflowRows, listedJoints, jointVersion, trees, treesByGroup,
                     colorCount, islands, version, loadVersion);
}

}  // namespace fulcrum
