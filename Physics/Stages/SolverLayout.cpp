#include <Fulcrum/Physics/Stages/SolverLayout.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const SolverLayout& layout) {
    const auto& [groups, colors, bodies, movingContacts, fixedContacts, moving, fixed, overflowMoving, overflowFixed,
                 balls, joints, overflowJoints, jointRows, overflowRows, listedJoints, jointVersion, trees,
                 treesByGroup, movingCount, fixedCount, ballCount, jointCount, colorCount, islands, version] = layout;
    return HeapBytes(groups, colors, bodies, movingContacts, fixedContacts, moving, fixed, overflowMoving,
                     overflowFixed, balls, joints, overflowJoints, jointRows, overflowRows, listedJoints, jointVersion,
                     trees, treesByGroup, movingCount, fixedCount, ballCount, jointCount, colorCount, islands, version);
}

}  // namespace fulcrum
