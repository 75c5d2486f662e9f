#include <Fulcrum/Physics/State/SolverLayout.h>

namespace fulcrum {

size_t SolverLayout::MemoryUsed() const {
    return groups.capacity() * sizeof(groups[0]) + colours.capacity() * sizeof(colours[0]) +
           bodies.capacity() * sizeof(bodies[0]) +
           (movingContacts.capacity() + fixedContacts.capacity()) * sizeof(ContactColouring::Entry) +
           moving.capacity() * sizeof(moving[0]) + fixed.capacity() * sizeof(fixed[0]) +
           overflowMoving.capacity() * sizeof(overflowMoving[0]) + overflowFixed.capacity() * sizeof(overflowFixed[0]);
}

}  // namespace fulcrum
