// A collider searches for pairs only when it leaves its fat bounds. These reach ahead along the velocity, so that a
// body in flight leaves them once in several steps.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/Crowd.h>

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

// Makes bounds about the center of a shape larger by how far a turn, a rotation vector in rad, takes what is inside of
// them: |turn x p| along each axis, of points p up to as far out as the bounds reach by then; never beyond the outer
// sphere. What turns so slowly that its ends do not leave where they were passes through nothing, and keeps its bounds.
void ExtendByTurn(const Shape& shape, const Vector3& turn, Vector3& lower, Vector3& upper) {
    const float outer = shape.OuterRadius(), angle = Length(turn);
    if (!(angle * outer > shape.InnerRadius())) return;
    const Vector3 sphere = Vector3::Constant(outer), rate = turn.cwiseAbs();
    const Vector3 far = Vector3(lower.cwiseAbs().cwiseMax(upper.cwiseAbs()) + sphere * angle).cwiseMin(sphere);
    const Vector3 swept(rate.y() * far.z() + rate.z() * far.y(), rate.z() * far.x() + rate.x() * far.z(),
                        rate.x() * far.y() + rate.y() * far.x());
    lower = Vector3(lower - swept).cwiseMax(-sphere);
    upper = Vector3(upper + swept).cwiseMin(sphere);
}

// Bounds of a collider at a pose about the origin of bounds while it turns by a rotation vector in rad, without any
// margin. A hull as round as a ball is bounded best by its outer sphere.
Bounds TightBounds(const Shape& shape, const Pose& pose, const Matrix3& rotation, const Vector3& turn) {
    const Bounds& local = shape.LocalBounds();
    const Vector3 center = rotation * local.Center(), half = local.HalfExtents();
    const Vector3 reach =
        rotation.x.cwiseAbs() * half.x() + rotation.y.cwiseAbs() * half.y() + rotation.z.cwiseAbs() * half.z();
    const Vector3 sphere = Vector3::Constant(shape.OuterRadius());
    Vector3 lower = Vector3(center - reach).cwiseMax(-sphere), upper = Vector3(center + reach).cwiseMin(sphere);
    ExtendByTurn(shape, turn, lower, upper);
    return RoundedOutwards(pose.position + lower.cast<double>(), pose.position + upper.cast<double>());
}

// A step's motion and the speculative distance on both sides.
Bounds Reach(const Bounds& tight, const Vector3& motion, float margin) {
    Bounds b;
    b.lower = tight.lower + motion.cwiseMin(0.0f) - Vector3::Constant(margin);
    b.upper = tight.upper + motion.cwiseMax(0.0f) + Vector3::Constant(margin);
    return b;
}

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
        const float speculative = 0.5f * world.settings.speculativeDistance;
        if (collider.fat.Contains(Reach(tight, motion, speculative))) return;
        const float radius = piece.shape->OuterRadius(), distance = Length(motion);
        const float margin = std::min(world.settings.boundsMargin, kAheadFraction * radius);
        if (distance > kFastPart * margin) {
            collider.fat = Reach(tight, motion, speculative);
        } else {
            const float ahead = kAheadFraction * radius / std::max(distance, 1e-6f);
            collider.fat = Reach(tight, motion * std::clamp(ahead, 1.0f, kStepsAhead), speculative + margin);
        }
        if (!collider.queued) findings.colliders.push_back(i);
        collider.queued = true;
        changed = true;
    });
    if (changed) world.bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(world.report.step);
}

// The lists of what moves and meets get room by the size of the world, so that no step of a settled one allocates,
// whichever worker does what.
void ReserveLists(WorldState& world) {
    const size_t colliders = world.colliders.colliders.capacity();
    world.colliders.moved.reserve(colliders);
    world.activated.reserve(colliders);
    world.began.reserve(colliders);
    world.newPairs.reserve(colliders);
    for (WorkerFindings& findings : world.findings) {
        findings.colliders.reserve(colliders);
        findings.pairs.reserve(colliders);
    }
}

// In the order of their ids, so that the shape of the trees and the lists of sensors repeat from run to run; neither
// depends on it where most moved and there are no sensors.
void ListMoved(WorldState& world) {
    std::vector<uint32_t>& moved = world.colliders.moved;
    const auto first = static_cast<ptrdiff_t>(moved.size());
    for (WorkerFindings& findings : world.findings) {
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
    store.fixedTree.Optimize();
}

}  // namespace

Bounds TightBoundsOf(const WorldState& world, uint32_t index) {
    const ColliderShape& piece = world.colliders.shapes[index];
    Pose body = world.bodies.CenterPoseOf(world.colliders.colliders[index].body);
    body.position -= world.colliders.boundsOrigin;
    const Pose pose = body * LocalOf(world, index);
    return TightBounds(*piece.shape, pose, ToMatrix(pose.rotation), Vector3::Zero());
}

void SetFatBounds(WorldState& world, uint32_t index) {
    const float margin = 0.5f * world.settings.speculativeDistance + world.settings.boundsMargin;
    world.colliders.colliders[index].fat = Reach(TightBoundsOf(world, index), Vector3::Zero(), margin);
}

void UpdateBounds(WorldState& world, const StepContext& step) {
    ReserveLists(world);
    PushDispersing(world, step.dt);
    BodyStore& bodies = world.bodies;
    const Vector3 gravity = world.settings.gravity;
    world.jobs->ParallelFor(static_cast<uint32_t>(bodies.awake.size()), 64, [&](JobRange range) {
        WorkerFindings& findings = world.findings[range.worker];
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
            UpdateColliders(world, body, step.dt, findings);
        }
    });
    SettleStopped(world);
    ListMoved(world);
    UpdateTrees(world);
}

}  // namespace fulcrum
