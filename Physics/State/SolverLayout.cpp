#include <Fulcrum/Physics/State/SolverLayout.h>

namespace fulcrum {

size_t SolverLayout::MemoryUsed() const {
    return groups.capacity() * sizeof(groups[0]) + colors.capacity() * sizeof(colors[0]) +
           bodies.capacity() * sizeof(bodies[0]) +
           (movingContacts.capacity() + fixedContacts.capacity()) * sizeof(ConstraintColoring::Entry) +
           moving.capacity() * sizeof(moving[0]) + fixed.capacity() * sizeof(fixed[0]) +
           overflowMoving.capacity() * sizeof(overflowMoving[0]) + overflowFixed.capacity() * sizeof(overflowFixed[0]) +
           balls.capacity() * sizeof(balls[0]) + joints.capacity() * sizeof(joints[0]) +
           overflowJoints.capacity() * sizeof(overflowJoints[0]) + listedJoints.capacity() * sizeof(listedJoints[0]) +
           trees.MemoryUsed() + jointRows.capacity() * sizeof(jointRows[0]) +
           overflowRows.capacity() * sizeof(overflowRows[0]);
}

}  // namespace fulcrum
