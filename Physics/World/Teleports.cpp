#include <Fulcrum/Physics/World/Teleports.h>

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// Tells all joints of the body's mechanism, once between two steps.
void NoteTeleport(WorldState& world, uint32_t body) {
    constexpr float kSecondsOfTeleport = 5;  // in which a mechanism comes together, see Docs/Joints.md
    JointStore& store = world.joints;
    Array<uint32_t>& bodies = world.sleeping.pending;
    bodies.clear();
    bodies.push_back(body);
    while (!bodies.empty()) {
        const uint32_t from = bodies.back();
        bodies.pop_back();
        store.VisitOf(from, [&](uint32_t index) {
            Joint& joint = store.joints[index];
            if (std::exchange(joint.teleportedBefore, world.step + 1) == world.step + 1) return;
            store.records[index].secondsOfTeleport = kSecondsOfTeleport;
            const int other = 1 - joint.SideOf(from);
            if (!joint.fixed[other]) bodies.push_back(joint.body[other]);
        });
    }
}

// Brings everything in line with a pose that the user set.
void UpdatePlaced(WorldState& world, uint32_t body) {
    if (world.bodies.dynamics[body].motion == MotionType::Dynamic) world.bodies.MarkPlaced(body);
    world.bodies.UpdateInertia(body);
    VisitColliders(world, body, [&](uint32_t i) {
        SetFatBounds(world.settings, world.bodies, world.colliders, i);
        const Collider& collider = world.colliders.colliders[i];
        world.colliders.TreeOf(collider).Update(i, collider.fat);
        world.outsideFatBounds.Forget(i);
    });
    world.bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world.step + 1);
    RequeueColliders(world.bodies, world.colliders, body);
}

void WakeAround(WorldState& world, uint32_t body) {
    if (world.bodies.dynamics[body].frozen) {
        world.bodies.dynamics[body].frozen = false;
        RecolorJointsOf(world.bodies, world.joints, world.coloring, body);
    }
    WakeBody(world, body);
    WakeNeighbors(world, body);
    WakeJoined(world, body);
}

// Bodies as indices or places.
template <class Bodies, class BodyOf, class PoseOf, class IsTorn>
void TeleportAll(WorldState& world, const Bodies& bodies, const BodyOf& bodyOf, const PoseOf& poseOf,
                 const IsTorn& isTorn) {
    for (const auto& body : bodies) WakeAround(world, bodyOf(body));
    for (const auto& body : bodies) world.bodies.SetCenterPose(bodyOf(body), poseOf(body));
    for (const auto& body : bodies) {
        if (isTorn(bodyOf(body))) NoteTeleport(world, bodyOf(body));
        UpdatePlaced(world, bodyOf(body));
    }
    for (const auto& body : bodies) WakeNeighbors(world, bodyOf(body));
}

}  // namespace

PosesBefore::PosesBefore(const BodyStore& bodies, std::span<const BodyPlace> places) : bodies_(bodies) {
    before_.reserve(places.size());
    for (const BodyPlace& place : places) before_.push_back({place.body, bodies.ExactCenterPoseOf(place.body)});
    std::ranges::sort(before_, {}, &BodyPlace::body);
}

bool PosesBefore::IsTorn(const JointStore& joints, uint32_t body) const {
    bool isTorn = false;
    joints.VisitOf(body, [&](uint32_t index) {
        const Joint& joint = joints.joints[index];
        isTorn |= !MovedTogether(body, joint.body[1 - joint.SideOf(body)]);
    });
    return isTorn;
}

bool PosesBefore::MovedTogether(uint32_t a, uint32_t b) const {
    constexpr float kSame = 1e-4f;  // m and rad: more than rounding far out leaves, less than shows
    const BodyPlace *beforeA = Find(a), *beforeB = Find(b);
    if (!beforeA || !beforeB) return false;
    const RelativePose then = Relative(beforeA->pose, beforeB->pose),
                       now = Relative(bodies_.ExactCenterPoseOf(a), bodies_.ExactCenterPoseOf(b));
    return Length(Vector3(now.position - then.position)) <= kSame &&
           Length(RotationVectorOf<float>(now.rotation * then.rotation.Conjugate())) <= kSame;
}

const BodyPlace* PosesBefore::Find(uint32_t body) const {
    const auto found = std::ranges::lower_bound(before_, body, {}, &BodyPlace::body);
    return found != before_.end() && found->body == body ? &*found : nullptr;
}

void Teleport(WorldState& world, std::span<const BodyPlace> places, const PosesBefore& before) {
    const auto poseOf = [&](const BodyPlace& place) {
        const Vector3 center = world.bodies.cold[place.body].shape->Mass().centerOfMass;
        return Pose{place.pose.position + Rotate(place.pose.rotation, center).cast<double>(), place.pose.rotation};
    };
    const auto isTorn = [&](uint32_t body) { return before.IsTorn(world.joints, body); };
    TeleportAll(
        world, places, [](const BodyPlace& place) { return place.body; }, poseOf, isTorn);
}

void Teleport(WorldState& world, std::span<const uint32_t> bodies, FunctionRef<Vector3(uint32_t)> displacementOf) {
    const auto poseOf = [&](uint32_t body) {
        const Pose pose = world.bodies.ExactCenterPoseOf(body);
        return Pose{pose.position + displacementOf(body).cast<double>(), pose.rotation};
    };
    const auto moves = [&](uint32_t body) { return std::ranges::binary_search(bodies, body); };
    const auto isTorn = [&](uint32_t body) {
        bool any = false;
        world.joints.VisitOf(body, [&](uint32_t index) {
            const Joint& joint = world.joints.joints[index];
            const uint32_t other = joint.body[1 - joint.SideOf(body)];
            any |= !moves(other) || displacementOf(other) != displacementOf(body);
        });
        return any;
    };
    TeleportAll(
        world, bodies, [](uint32_t body) { return body; }, poseOf, isTorn);
}

}  // namespace fulcrum
