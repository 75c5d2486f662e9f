#include <Fulcrum/Physics/World/Waking.h>

#include <Fulcrum/Physics/World/Colors.h>

#include <algorithm>

namespace fulcrum {

namespace {

void WakeOne(const SleepStores& stores, uint32_t body) {
    BodyStore& bodies = stores.bodies;
    bodies.MarkAwake(body);
    bodies.cold[body].sleepingIsland = SleepingIslands::kNone;
    bodies.UpdateInertia(body);
    const BodyDynamics& dynamics = bodies.dynamics[body];
    Vector3 acceleration = bodies.GravityOf(body, stores.settings.gravity) * dynamics.gravityFactor;
    if (dynamics.hasForce) acceleration += bodies.cold[body].force * dynamics.inverseMass;
    for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] = acceleration[k];
    RequeueColliders(bodies, stores.colliders, body);
}

}  // namespace

void RequeueColliders(const BodyStore& bodies, ColliderStore& colliders, uint32_t body) {
    VisitColliders(bodies, colliders, body, [&](uint32_t i) {
        colliders.colliders[i].previous = {};
        colliders.Queue(i);
    });
}

void WakeBody(const SleepStores& stores, uint32_t body) {
    // Not what was removed since the last step, whose pairs are there still: it would be awake for ever.
    const auto maySleep = [&](uint32_t b) {
        return stores.bodies.dynamics[b].motion == MotionType::Dynamic && !stores.bodies.dynamics[b].frozen &&
               !stores.bodies.cold[b].removed;
    };
    if (!maySleep(body)) return;
    if (stores.bodies.dynamics[body].awake) {
        stores.bodies.dynamics[body].slowSeconds = 0;
        return;
    }
    Array<uint32_t>& pending = stores.sleeping.pending;
    pending.clear();
    pending.push_back(body);
    const auto wake = [&](uint32_t member) {
        WakeOne(stores, member);
        stores.joints.VisitOf(member, [&](uint32_t index) {
            const Joint& joint = stores.joints.joints[index];
            if (!joint.enabled) return;
            ColorJoint(stores.bodies, stores.joints, stores.coloring, index);
            pending.push_back(joint.body[1 - joint.SideOf(member)]);
        });
    };
    while (!pending.empty()) {
        const uint32_t next = pending.back();
        pending.pop_back();
        if (!maySleep(next) || stores.bodies.dynamics[next].awake) continue;
        const uint32_t island = stores.bodies.cold[next].sleepingIsland;
        if (island == SleepingIslands::kNone) {
            wake(next);
            continue;
        }
        for (uint32_t member : stores.sleeping.Bodies(island)) wake(member);
        stores.sleeping.Remove(island);
    }
}

void WakeJoined(const SleepStores& stores, uint32_t body) {
    stores.joints.VisitOf(body, [&](uint32_t index) {
        const Joint& joint = stores.joints.joints[index];
        if (joint.enabled) WakeBody(stores, joint.body[1 - joint.SideOf(body)]);
    });
}

void WakeInside(const SleepStores& stores, const Bounds& bounds) {
    // Collects the bodies first, since the world must not change during a query.
    Array<uint32_t>& found = stores.sleeping.inside;
    found.clear();
    stores.colliders.movingTree.Query(
        bounds, [&](uint32_t collider) { found.push_back(stores.colliders.colliders[collider].body); });
    std::sort(found.begin(), found.end());
    for (uint32_t body : found) WakeBody(stores, body);
}

}  // namespace fulcrum
