#include <Fulcrum/Physics/World/JointChanges.h>

#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

namespace {

// The two bodies must no longer collide.
void DropPairs(WorldState& world, const Joint& joint) {
    VisitColliders(world, joint.body[0], [&](uint32_t i) {
        VisitColliders(world, joint.body[1], [&](uint32_t j) {
            const uint32_t pair = world.pairs.Find(i, j);
            if (pair != PairStore::kNone) RemovePair(world.pairs, world.coloring, pair);
        });
    });
}

}  // namespace

std::optional<MotionType> MotionOf(const WorldState& world, BodyId id) {
    if (id == kWorldBody) return MotionType::Static;
    if (!world.bodies.Find(id)) return std::nullopt;
    return world.bodies.dynamics[id.index].motion;
}

void IncludeJoint(const WorldState& world, const JointSettings& settings, Additions& more) {
    ++more.joints;
    for (const BodyId body : {settings.bodyA, settings.bodyB})
        more.worldBody |= body == kWorldBody && world.bodies.worldBody == BodyStore::kNone;
    if (more.worldBody) (void)ShapeOfWorldBody();  // is made now
    if (!settings.collideConnected && world.bodies.Find(settings.bodyA))
        more.removedPairs += CountPairsOf(world, settings.bodyA.index);
}

size_t PairsEndedBy(const WorldState& world, const Joint& joint) {
    return joint.collideConnected ? 0 : CountPairsOf(world, joint.body[0]);
}

void WakeBodiesOf(WorldState& world, const Joint& joint) {
    for (uint32_t body : joint.body) WakeBody(world, body);
}

void EnableJoint(WorldState& world, uint32_t index, bool enabled) {
    Joint& joint = world.joints.joints[index];
    joint.enabled = enabled;
    if (enabled) {
        if (!joint.collideConnected) DropPairs(world, joint);
        WakeBodiesOf(world, joint);
        ColorJoint(world.bodies, world.joints, world.coloring, index);
    } else {
        WakeBodiesOf(world, joint);
        UncolorJoint(world.joints, world.coloring, index);
        world.joints.Forget(index);
        for (uint32_t body : joint.body) RequeueColliders(world.bodies, world.colliders, body);
    }
}

void RemoveJoint(WorldState& world, uint32_t index) {
    EnableJoint(world, index, false);
    world.joints.Unlink(index);
    world.joints.Free(index);
}

}  // namespace fulcrum
