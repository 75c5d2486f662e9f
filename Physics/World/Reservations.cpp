#include <Fulcrum/Physics/World/Reservations.h>

#include <Fulcrum/Physics/World/ReserveMore.h>

namespace fulcrum {

void ReserveForChange(WorldState& world, const Additions& more) {
    BodyStore& bodies = world.bodies;
    ColliderStore& colliders = world.colliders;
    JointStore& joints = world.joints;
    const size_t moreBodies = more.bodies + more.worldBody;
    bodies.Reserve(moreBodies, more.placed);
    const size_t allBodies = bodies.Size() + moreBodies, allColliders = colliders.colliders.size() + more.colliders;
    colliders.Reserve(more.colliders);
    colliders.staticTree.ReserveInsertions(more.inStatic, allColliders);
    colliders.movingTree.ReserveInsertions(more.inMoving, allColliders);
    colliders.sensorTree.ReserveInsertions(more.inSensors, allColliders);
    joints.Reserve(more.joints, allBodies);
    if (joints.Count() > 0) ReserveMore(joints.moved, more.placed);
    const size_t allJoints = joints.joints.size() + more.joints;
    if (allJoints > 0) world.coloring.ReserveBodies(static_cast<uint32_t>(allBodies));
    world.coloring.Postpone(allJoints);
    // A joint is pending for each of its bodies.
    ReserveRoom(world.sleeping.pending, 2 * allJoints + 1);
    ReserveRoom(world.sleeping.inside, size_t{colliders.movingTree.Size()} + more.inMoving);
    world.sleeping.ReserveRemoval();
    if (more.sensors > 0) ReserveMore(world.sensors.sensors, more.sensors);
    if (more.sensors > 0 || !world.sensors.IsEmpty()) ReserveMore(world.sensors.changed, 2 * more.bodies + 2);
    world.pairs.ReserveRemovals(more.removedPairs);
    ReserveMore(world.removed, 1);
}

void ReserveToWake(WorldState& world, uint32_t body) {
    const BodyDynamics& d = world.bodies.dynamics[body];
    if (d.motion == MotionType::Dynamic && !d.awake) ReserveForChange(world);
}
void ReserveToWake(WorldState& world, const Joint& joint) {
    for (const uint32_t body : joint.body) ReserveToWake(world, body);
}

size_t CountPairsOf(const WorldState& world, uint32_t body) {
    size_t count = 0;
    VisitColliders(world, body, [&](uint32_t collider) { count += world.pairs.CountOf(collider); });
    return count;
}

}  // namespace fulcrum
