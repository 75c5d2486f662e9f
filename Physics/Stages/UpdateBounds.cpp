// A collider searches for pairs only when it leaves its fat bounds. These are extended along the velocity, so that a
// moving body leaves them only every few steps.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Fat bounds are extended by the motion of this many steps, but not by much more than the body's size: a superfluous
// pair costs more than a search.
constexpr float kStepsAhead = 4;
constexpr float kAheadFraction = 0.25f;  // of the outer radius
// A body that moves by this fraction of the margin in a step would leave fat bounds so soon that they only cost pairs:
// it gets tight ones.
constexpr float kFastFraction = 0.5f;

void UpdateColliders(const StepContext& step, uint32_t body, BodyStore& bodies, ColliderStore& colliders,
                     WorkerFindings& findings) {
    Pose pose = bodies.CenterPoseOf(body);
    pose.position -= colliders.boundsOrigin;
    const Matrix3 rotation = ToMatrix(pose.rotation);
    const Vector3 linear = bodies.LinearVelocityOf(body), angular = bodies.AngularVelocityOf(body);
    const Vector3 turn = angular * step.dt;
    bool changed = false;
    VisitColliders(bodies, colliders, body, [&](uint32_t i) {
        Collider& collider = colliders.colliders[i];
        const ColliderShape& piece = colliders.shapes[i];
        Bounds tight;
        Vector3 motion = linear * step.dt;
        if (piece.offset) {
            const RelativePose local = LocalOf(bodies, colliders, i);
            const Pose at = pose * local;
            tight = TightBounds(*piece.shape, at, ToMatrix(at.rotation), turn);
            motion += Cross<float>(angular, Vector3(rotation * local.position)) * step.dt;
        } else {
            tight = TightBounds(*piece.shape, pose, rotation, turn);
        }
        const float speculative = 0.5f * SpeculativeDistance(step.settings, *piece.shape);
        if (collider.fat.Contains(BoundsAlong(tight, motion, speculative))) return;
        const float radius = piece.shape->OuterRadius(), distance = Length(motion);
        const float margin = BoundsMargin(step.settings, *piece.shape);
        if (distance > kFastFraction * margin) {
            collider.fat = BoundsAlong(tight, motion, speculative);
        } else {
            const float ahead = kAheadFraction * radius / std::max(distance, 1e-6f);
            collider.fat = BoundsAlong(tight, motion * std::clamp(ahead, 1.0f, kStepsAhead), speculative + margin);
        }
        if (!collider.queued) findings.colliders.push_back(i);
        collider.queued = true;
        changed = true;
    });
    if (changed) bodies.poses[body].boundsChangedIn = static_cast<uint32_t>(step.number);
}

// Reserves the lists of moved colliders by the size of the world, so that steps in steady state do not allocate,
// whichever worker does the work.
void ReserveLists(ColliderStore& colliders, std::span<WorkerFindings> workers) {
    const size_t most = colliders.colliders.capacity();
    colliders.moved.reserve(most);
    for (WorkerFindings& findings : workers) findings.colliders.reserve(most);
}

// Sorted by id, so that trees and sensor lists are deterministic. Not needed if most colliders moved and there are no
// sensors.
void ListMoved(const SensorStore& sensors, ColliderStore& colliders, std::span<WorkerFindings> workers) {
    Array<uint32_t>& moved = colliders.moved;
    const auto first = static_cast<ptrdiff_t>(moved.size());
    for (WorkerFindings& findings : workers) {
        moved.insert(moved.end(), findings.colliders.begin(), findings.colliders.end());
        findings.colliders.clear();
    }
    if (!colliders.MostMoved() || !sensors.IsEmpty()) std::sort(moved.begin() + first, moved.end());
}

void UpdateTrees(ColliderStore& store, JobSystem& jobs) {
    const bool together = store.MostMoved();
    if (together) {
        jobs.ParallelFor(store.movingTree.NodeCount(), 32, [&](JobRange range) {
            store.movingTree.UpdateLeaves(range.begin, range.end,
                                          [&](uint32_t i) -> const Bounds& { return store.colliders[i].fat; });
        });
        store.movingTree.NoteUpdated(static_cast<uint32_t>(store.moved.size()));
    }
    for (uint32_t i : store.moved) {
        const Collider& collider = store.colliders[i];
        if (!together || !collider.moving || collider.sensor) store.TreeOf(collider).Update(i, collider.fat);
    }
    // Each collider that moved searches both trees, as far as it is not static itself.
    const uint32_t searches = static_cast<uint32_t>(store.moved.size());
    for (BoundsTree* tree : {&store.movingTree, &store.staticTree}) {
        // For the rebuild, which may come in any later step.
        if (tree->IsMostlyPending()) tree->Reserve(store.colliders.capacity());
        tree->Optimize(searches, LoopOn(jobs));
    }
}

}  // namespace

void UpdateBounds(const StepContext& step, const PairStore& pairs, const SensorStore& sensors, BodyStore& bodies,
                  ColliderStore& colliders, Array<DispersingBody>& dispersing, const StepWorkers& workers) {
    ReserveLists(colliders, workers.findings);
    PushDispersing(step, colliders, pairs, bodies, dispersing, workers.jobs);
    const Vector3 gravity = step.settings.gravity;
    workers.jobs.ParallelFor(static_cast<uint32_t>(bodies.awake.size()), 64, [&](JobRange range) {
        WorkerFindings& findings = workers.findings[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t body = bodies.awake[i];
            AdmitBody(bodies, colliders, body, findings);
            const BodyDynamics& dynamics = bodies.dynamics[body];
            if (dynamics.motion == MotionType::Dynamic) {
                if (!dynamics.spherical) bodies.UpdateInertia(body);
                Vector3 acceleration = (dynamics.special ? bodies.GravityOf(body, gravity) : gravity) *
                                       (dynamics.dispersing ? 0.0f : dynamics.gravityFactor);
                if (dynamics.hasForce) acceleration += bodies.cold[body].force * dynamics.inverseMass;
                if (dynamics.frozen) acceleration.setZero();
                if (dynamics.LockedTranslations() != 0) acceleration = dynamics.AlongFreeTranslations(acceleration);
                for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] = acceleration[k];
            }
            UpdateColliders(step, body, bodies, colliders, findings);
        }
    });
    ListMoved(sensors, colliders, workers.findings);
    UpdateTrees(colliders, workers.jobs);
}

}  // namespace fulcrum
