#include <Fulcrum/Physics/World/Teleports.h>

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/IndexSet.h>
#include <Fulcrum/Physics/World/JointErrors.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Of bodies that are each named once. The first pose since the last step counts.
void NoteMoved(WorldState& world, std::span<const BodyPlace> places) {
    Array<MovedBody>& moved = world.joints.moved;
    const size_t before = moved.size();
    for (const BodyPlace& place : places) {
        const auto earlier = std::span(moved).first(before);
        if (!world.joints.HasAny(place.body) ||
            std::ranges::find(earlier, place.body, &MovedBody::body) != earlier.end())
            continue;
        moved.push_back({place.body, world.bodies.ExactCenterPoseOf(place.body)});
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

uint32_t BodyOf(uint32_t body) { return body; }
uint32_t BodyOf(const BodyPlace& place) { return place.body; }

// Bodies as indices or places.
template <class Bodies, class PoseOf>
void TeleportAll(WorldState& world, const Bodies& bodies, const PoseOf& poseOf) {
    for (const auto& body : bodies) WakeAround(world, BodyOf(body));
    for (const auto& body : bodies) world.bodies.SetCenterPose(BodyOf(body), poseOf(body));
    for (const auto& body : bodies) UpdatePlaced(world, BodyOf(body));
    for (const auto& body : bodies) WakeNeighbors(world, BodyOf(body));
}

// Whether a joint is apart by more than the size of a body, or turned by more than half a radian, beyond which its rows
// are not linear, since the other body was moved by as much. Less is corrected by the step, without hurry.
bool IsFarApart(const WorldState& world, uint32_t joint, uint32_t body, const MovedBody& moved) {
    constexpr float kTurned = 0.5f;
    const float size = world.bodies.dynamics[body].outerRadius;
    const RelativePose way = Relative(moved.before, world.bodies.ExactCenterPoseOf(moved.body));
    if (Length(way.position) <= size && Length(RotationVectorOf<float>(way.rotation)) <= kTurned) return false;
    const JointError error = StretchOfJoint(world, joint);
    return error.distance > size || error.angle > kTurned;
}

class Followers {
public:
    explicit Followers(WorldState& world) : world_(world), given_(world.joints.moved.size()) {
        moved_.Reserve(world.bodies.Size());
        for (const MovedBody& moved : world.joints.moved) moved_.Insert(moved.body);
    }

    // Breadth first, from all moved bodies at once: each of the others follows that which the fewest joints separate.
    void Place() {
        Array<MovedBody>& moved = world_.joints.moved;
        for (size_t i = 0; i < moved.size(); ++i) {
            const uint32_t body = moved[i].body;
            VisitLinked(body, [&](uint32_t joint, uint32_t other) {
                if (moved_.Contains(other) || !IsFree(other) || (i < given_ && !MayFollow(joint, other, i))) return;
                moved_.Insert(other);
                moved.push_back({other, world_.bodies.ExactCenterPoseOf(other)});
                Pose now = world_.bodies.ExactCenterPoseOf(body) * Relative(moved[i].before, moved.back().before);
                now.rotation = Normalized(now.rotation);
                TeleportAll(world_, std::span(&other, 1), [&](uint32_t) { return now; });
            });
        }
    }

private:
    // Calls visit(joint, other body) for the joints that hold a body to others.
    template <class Visit>
    void VisitLinked(uint32_t body, Visit&& visit) const {
        const JointStore& store = world_.joints;
        store.VisitOf(body, [&](uint32_t index) {
            const Joint& joint = store.joints[index];
            if (joint.enabled && !joint.type->ReactsOnWorld()) visit(index, joint.body[1 - joint.SideOf(body)]);
        });
    }
    const MovedBody& Moved(uint32_t body) const {
        return *std::ranges::find(world_.joints.moved, body, &MovedBody::body);
    }
    bool IsFree(uint32_t body) const {
        const BodyDynamics& d = world_.bodies.dynamics[body];
        return d.motion == MotionType::Dynamic && !d.frozen;
    }
    // Whether the joint to this body, which was not moved, is far apart, and nothing else keeps the body where it is.
    bool MayFollow(uint32_t joint, uint32_t body, size_t moved) const {
        return IsFarApart(world_, joint, body, world_.joints.moved[moved]) && !IsAnchored(body);
    }
    // Whether joints hold a body to one that is immovable, or was moved but not far from it.
    bool IsAnchored(uint32_t body) const {
        IndexSet seen;
        seen.Reserve(world_.bodies.Size());
        seen.Insert(body);
        Array<uint32_t> open = {body};
        bool isAnchored = false;
        while (!open.empty() && !isAnchored) {
            const uint32_t from = open.back();
            open.pop_back();
            VisitLinked(from, [&](uint32_t joint, uint32_t other) {
                if (moved_.Contains(other)) isAnchored |= !IsFarApart(world_, joint, from, Moved(other));
                else if (!IsFree(other)) isAnchored = true;
                else if (seen.Insert(other)) open.push_back(other);
            });
        }
        return isAnchored;
    }

    WorldState& world_;
    size_t given_;  // bodies that the user moved; those that follow come after them
    IndexSet moved_;
};

}  // namespace

void Teleport(WorldState& world, std::span<const BodyPlace> places) {
    NoteMoved(world, places);
    TeleportAll(world, places, [&](const BodyPlace& place) {
        const Vector3 center = world.bodies.cold[place.body].shape->Mass().centerOfMass;
        return Pose{place.pose.position + Rotate(place.pose.rotation, center).cast<double>(), place.pose.rotation};
    });
}

void Teleport(WorldState& world, std::span<const uint32_t> bodies, FunctionRef<Vector3(uint32_t)> displacementOf) {
    TeleportAll(world, bodies, [&](uint32_t body) {
        const Pose pose = world.bodies.ExactCenterPoseOf(body);
        return Pose{pose.position + displacementOf(body).cast<double>(), pose.rotation};
    });
}

void FollowMovedBodies(WorldState& world) {
    if (world.joints.moved.empty()) return;
    Followers(world).Place();
    world.joints.moved.clear();
}

}  // namespace fulcrum
