#include <Fulcrum/Physics/World/Waking.h>

#include <Fulcrum/Physics/World/Colors.h>

#include <algorithm>

namespace fulcrum {

namespace {

void WakeOne(WorldState& world, uint32_t body) {
    BodyStore& bodies = world.bodies;
    bodies.MarkAwake(body);
    bodies.cold[body].sleepingIsland = SleepingIslands::kNone;
    bodies.UpdateInertia(body);
    const Vector3 acceleration = world.settings.gravity * bodies.dynamics[body].gravityFactor;
    for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] = acceleration[k];
    RequeueColliders(world, body);
}

}  // namespace

void RequeueColliders(WorldState& world, uint32_t body) {
    VisitColliders(world, body, [&](uint32_t i) {
        world.colliders.colliders[i].previous = {};
        world.colliders.Queue(i);
    });
}

void WakeBody(WorldState& world, uint32_t body) {
    const auto maySleep = [&](uint32_t b) {
        return world.bodies.dynamics[b].motion == MotionType::Dynamic && !world.bodies.dynamics[b].frozen;
    };
    if (!maySleep(body)) return;
    if (world.bodies.dynamics[body].awake) {
        world.bodies.dynamics[body].slowSeconds = 0;
        return;
    }
    std::vector<uint32_t> pending = {body};
    const auto wake = [&](uint32_t member) {
        WakeOne(world, member);
        world.joints.VisitOf(member, [&](uint32_t index) {
            const Joint& joint = world.joints.joints[index];
            if (!joint.enabled) return;
            ColorJoint(world, index);
            pending.push_back(joint.body[1 - joint.SideOf(member)]);
        });
    };
    while (!pending.empty()) {
        const uint32_t next = pending.back();
        pending.pop_back();
        if (!maySleep(next) || world.bodies.dynamics[next].awake) continue;
        const uint32_t island = world.bodies.cold[next].sleepingIsland;
        if (island == SleepingIslands::kNone) {
            wake(next);
            continue;
        }
        for (uint32_t member : world.sleeping.Bodies(island)) wake(member);
        world.sleeping.Remove(island);
    }
}

void WakeJoined(WorldState& world, uint32_t body) {
    world.joints.VisitOf(body, [&](uint32_t index) {
        const Joint& joint = world.joints.joints[index];
        if (joint.enabled) WakeBody(world, joint.body[1 - joint.SideOf(body)]);
    });
}

void WakeInside(WorldState& world, const Bounds& bounds) {
    // Waking changes no tree, but collect first: a query must not see the world change under it.
    std::vector<uint32_t> found;
    world.colliders.movingTree.Query(
        bounds, [&](uint32_t collider) { found.push_back(world.colliders.colliders[collider].body); });
    std::sort(found.begin(), found.end());
    for (uint32_t body : found) WakeBody(world, body);
}

}  // namespace fulcrum
