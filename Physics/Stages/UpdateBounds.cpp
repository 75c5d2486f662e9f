// A collider searches for pairs only when it leaves its fat bounds. These reach ahead along the velocity, so that a
// body in flight leaves them once in several steps.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Fat bounds reach so many steps along the velocity, but hardly farther than the body is large: every pair too many
// costs more than a search.
constexpr float kStepsAhead = 4;
constexpr float kAheadFraction = 0.25f;  // of the outer radius
// What moves by this part of the margin in a step would leave fat bounds so soon that they only cost pairs: it gets
// tight ones.
constexpr float kFastPart = 0.5f;

void UpdateColliders(WorldState& world, uint32_t body, float dt, WorkerFindings& findings) {
    Pose pose = world.bodies.CenterPoseOf(body);
    pose.position -= world.colliders.boundsOrigin;
    const Matrix3 rotation = ToMatrix(pose.rotation);
    const Vector3 linear = world.bodies.LinearVelocityOf(body), angular = world.bodies.AngularVelocityOf(body);
    const Vector3 turn = angular * dt;
    bool changed = false;
    VisitColliders(world, body, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        const ColliderShape& piece = world.colliders.shapes[i];
        Bounds tight;
        Vector3 motion = linear * dt;
        if (piece.offset) {
            const RelativePose local = LocalOf(world, i);
            const Pose at = pose * local;
            tight = TightBounds(*piece.shape, at, ToMatrix(at.rotation), turn);
            motion += Cross<float>(angular, Vector3(rotation * local.position)) * dt;
        } else {
            tight = TightBounds(*piece.shape, pose, rotation, turn);
        }
        const float speculative = 0.5f * SpeculativeDistance(world.settings, *piece.shape);
        if (collider.fat.Contains(BoundsAlong(tight, motion, speculative))) return;
        const float radius = piece.shape->OuterRadius(), distance = Length(motion);
        const float margin = BoundsMargin(world.settings, *piece.shape);
        if (distance > kFastPart * margin) {
            collider.fat = BoundsAlong(tight, motion, speculative);
        } else {
            const float ahead = kAheadFraction * radius / std::max(distance, 1e-6f);
            collider.fat = BoundsAlong(tight, motion * std::clamp(ahead, 1.0f, kStepsAhead), speculative + margin);
        }
        if (!collider.queued) findings.colliders.push_back(i);
        collider.queued = true;
        changed = true;
    });
    if (changed) world.bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world.step);
}

// The lists of what moves get room by the size of the world, so that no step of a settled one allocates, whichever
// worker does what.
void ReserveLists(ColliderStore& colliders, std::span<WorkerFindings> workers) {
    const size_t most = colliders.colliders.capacity();
    colliders.moved.reserve(most);
    for (WorkerFindings& findings : workers) findings.colliders.reserve(most);
}

// In the order of their ids, so that the shape of the trees and the lists of sensors repeat from run to run; neither
// depends on it where most moved and there are no sensors.
void ListMoved(WorldState& world, std::span<WorkerFindings> workers) {
    std::vector<uint32_t>& moved = world.colliders.moved;
    const auto first = static_cast<ptrdiff_t>(moved.size());
    for (WorkerFindings& findings : workers) {
        moved.insert(moved.end(), findings.colliders.begin(), findings.colliders.end());
        findings.colliders.clear();
    }
    if (!world.colliders.MostMoved() || !world.sensors.IsEmpty()) std::sort(moved.begin() + first, moved.end());
}

void UpdateTrees(WorldState& world) {
    ColliderStore& store = world.colliders;
    const bool together = store.MostMoved();
    if (together) {
        world.jobs->ParallelFor(store.movingTree.NodeCount(), 32, [&](JobRange range) {
            store.movingTree.UpdateLeaves(range.begin, range.end,
                                          [&](uint32_t i) -> const Bounds& { return store.colliders[i].fat; });
        });
        store.movingTree.NoteUpdated(static_cast<uint32_t>(store.moved.size()));
    }
    for (uint32_t i : store.moved) {
        const Collider& collider = store.colliders[i];
        if (!together || !collider.moving || collider.sensor) store.TreeOf(collider).Update(i, collider.fat);
    }
    store.movingTree.Optimize();
    store.staticTree.Optimize();
}

}  // namespace

void UpdateBounds(WorldState& world, float dt, std::vector<DispersingBody>& dispersing,
                  std::span<WorkerFindings> workers) {
    ReserveLists(world.colliders, workers);
    PushDispersing(world, dispersing, dt);
    BodyStore& bodies = world.bodies;
    const Vector3 gravity = world.settings.gravity;
    world.jobs->ParallelFor(static_cast<uint32_t>(bodies.awake.size()), 64, [&](JobRange range) {
        WorkerFindings& findings = workers[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t body = bodies.awake[i];
            AdmitBody(world, body, findings);
            const BodyDynamics& dynamics = bodies.dynamics[body];
            if (dynamics.motion == MotionType::Dynamic) {
                if (!dynamics.spherical) bodies.UpdateInertia(body);
                Vector3 acceleration = gravity * (dynamics.dispersing ? 0.0f : dynamics.gravityFactor);
                if (dynamics.hasForce) acceleration += bodies.cold[body].force * dynamics.inverseMass;
                if (dynamics.frozen) acceleration.setZero();
                for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] = acceleration[k];
            }
            UpdateColliders(world, body, dt, findings);
        }
    });
    SettleStopped(world, workers);
    ListMoved(world, workers);
    UpdateTrees(world);
}

}  // namespace fulcrum
