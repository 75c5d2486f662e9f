// Everything a PhysicsSystem holds. The stages are functions over it; each says what it reads and writes.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>
#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/Islands/SleepingIslands.h>
#include <Fulcrum/Physics/State/BodyStore.h>
#include <Fulcrum/Physics/State/ColliderStore.h>
#include <Fulcrum/Physics/State/JointStore.h>
#include <Fulcrum/Physics/State/PairStore.h>
#include <Fulcrum/Physics/State/SensorStore.h>
#include <Fulcrum/Physics/State/SolverLayout.h>
#include <Fulcrum/Physics/State/CollidersOutsideFatBounds.h>
#include <Fulcrum/Physics/State/SweepStore.h>
#include <Fulcrum/Physics/State/WorldLock.h>
#include <Fulcrum/Physics/StepReport.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

namespace fulcrum {

class ContactListener;

// A manifold that a pair with a surface has beyond those it had.
struct MoreManifold {
    uint32_t pair;
    uint32_t order;  // among those of the pair
    SurfaceManifold contact;
};

// One worker's own findings in a stage; merged in an order that does not depend on who found what.
struct alignas(64) WorkerFindings {
    std::vector<uint32_t> colliders;        // UpdateBounds: those that left their fat bounds
    std::vector<uint64_t> pairs;            // FindPairs: keys of new or resting pairs
    uint32_t deepPairs = 0;                 // FindPairs: how many of these pairs overlap deeply
    std::vector<uint32_t> deepOverlaps;     // Collide: bodies that overlap another deeply, once for each such overlap
    std::vector<uint32_t> crowdedOverlaps;  // Collide: crowded bodies that overlap another, likewise
    SurfaceContacts surface;                // Collide: room to work in
    std::vector<uint32_t> surfacePlaces, surfaceLeft, surfaceTouched;  // Collide: likewise
    std::vector<MoreManifold> more;                                    // Collide: what has no place in its pair yet
    std::vector<SweepHit> sweepHits;                                   // Continuous
    std::vector<uint64_t> sensorCandidates;                            // Sense
    std::vector<SensorVisit> sensorVisits;                             // likewise
    uint32_t sensorTests = 0;                                          // likewise
    CollideCounters libccd;
    uint32_t contacts = 0, points = 0, kept = 0;
    float deepest = 0;  // largest penetration, m
    uint32_t deepestPair = ~0u;
    uint32_t clamped = 0, frozen = 0;
    uint32_t firstFrozen = ~0u;
    uint32_t sleepCandidates = 0;  // bodies that have been slow for long enough
    bool bounces = false;          // Prepare: some contact has restitution
    JointFindings joints;          // Prepare
};

// A body that deeply overlapped many others and disperses (Stages/Crowd.h): until there is room it does not collide
// with dynamic bodies and gravity does not act on it, and it moves with `push` on top of its own velocity.
struct DispersingBody {
    uint32_t body;
    Vector3 direction;                  // of the push without a place, of length 1 at most: a part of the fastest push
    bool hasPlace = false;              // it moves to `place`
    Position place = Position::Zero();  // m
    float secondsLeft = 0;              // until it is to be there; below zero since then
    uint64_t startStep = 0;             // the step in which it started
    Vector3 push = Vector3::Zero(), ownVelocity = Vector3::Zero();  // m/s, of this step
};

// What Collide found out about an active pair that the rest of the world must hear of.
enum class PairChange : uint8_t { None, Began, Ended, Dead, WakesOther };

struct WorldState {
    SystemSettings settings;
    std::unique_ptr<ThreadPool> ownJobs;
    std::unique_ptr<JobSystem> jobs;  // the user's, or our own, as WorldJobs
    const ContactListener* listener = nullptr;

    BodyStore bodies;
    ColliderStore colliders;
    PairStore pairs;
    JointStore joints;
    ConstraintColoring coloring;
    SleepingIslands sleeping;
    SolverLayout solver;
    SweepStore sweeps;
    SensorStore sensors;

    std::vector<JointId> broken;      // in the last step
    std::vector<uint32_t> removed;    // bodies to forget before the next step
    std::vector<PairChange> changes;  // by pair, of this step; None for those that are not active
    std::vector<uint32_t> activated;  // pairs that FindPairs made active
    std::vector<uint32_t> began;      // Color: pairs that began to touch
    std::vector<uint64_t> newPairs;
    std::vector<MoreManifold> moreManifolds;
    std::vector<uint32_t>
        deepOverlaps;  // Collide: bodies, ascending, once for each deep overlap; empty if none has many
    std::vector<DispersingBody> dispersing;  // by body, ascending
    std::vector<uint32_t> crowded;         // these, and those that have dispersed and still overlap something; repeated
    std::vector<uint32_t> ghosts;          // pairs that DropGhosts took the points from, in the last step
    std::vector<WorkerFindings> findings;  // by worker
    ScratchArena scratch;
    StepReport report;
    bool bounces = false;     // some contact of this step has restitution
    float lastSubstepDt = 0;  // s

    // For the queries.
    WorldLock lock;
    CollidersOutsideFatBounds outsideFatBounds;

    size_t MemoryUsed() const;
};

// Calls visit(collider) for the pieces of a body.
template <class Visitor>
void VisitColliders(const WorldState& world, uint32_t body, Visitor&& visit) {
    const BodyCold& cold = world.bodies.cold[body];
    const auto visitRun = [&](uint32_t first, uint32_t count) {
        for (uint32_t i = first; i < first + count; ++i)
            if (world.colliders.shapes[i].shape) visit(i);
    };
    visitRun(cold.firstCollider, cold.colliderCount);
    for (uint32_t run = cold.MoreColliders(); run != ColliderStore::kNone; run = world.colliders.runs[run].next)
        visitRun(world.colliders.runs[run].first, world.colliders.runs[run].count);
}

// Which piece of its body a collider is.
inline uint32_t ChildOf(const WorldState& world, uint32_t collider) {
    const BodyCold& cold = world.bodies.cold[world.colliders.colliders[collider].body];
    uint32_t before = 0;
    ColliderRun run{cold.firstCollider, cold.colliderCount, cold.MoreColliders()};
    while (collider - run.first >= run.count) {
        before += run.count;
        run = world.colliders.runs[run.next];
    }
    return before + (collider - run.first);
}

// The piece's center frame in that of its body.
inline RelativePose LocalOf(const WorldState& world, uint32_t collider) {
    const ColliderShape& piece = world.colliders.shapes[collider];
    if (!piece.onOrigin) return piece.local;
    return {piece.local.position + world.bodies.cold[world.colliders.colliders[collider].body].children->origin,
            piece.local.rotation};
}

// World space, of the piece's own frame.
inline Pose ColliderPoseOf(const WorldState& world, uint32_t collider) {
    const Pose body = world.bodies.CenterPoseOf(world.colliders.colliders[collider].body);
    return world.colliders.shapes[collider].offset ? body * LocalOf(world, collider) : body;
}

// The piece, seen from its body's center frame.
inline ColliderShape PieceOf(const WorldState& world, uint32_t collider) {
    ColliderShape piece = world.colliders.shapes[collider];
    piece.local = LocalOf(world, collider);
    return piece;
}

// Whether a body is a single collider, which stays so.
inline bool IsOnePiece(const WorldState& world, uint32_t body) {
    const BodyCold& cold = world.bodies.cold[body];
    return cold.colliderCount == 1 && !cold.children;
}

// Visits the pairs with a change, in ascending order; in most steps that are few.
template <class Visitor>
void VisitChanges(const WorldState& world, Visitor&& visit) {
    const size_t count = world.changes.size();
    for (size_t i = 0; i < count;) {
        uint64_t eight = 0;
        if (i + 8 <= count) {
            std::memcpy(&eight, &world.changes[i], 8);
            if (eight == 0) {
                i += 8;
                continue;
            }
        }
        for (const size_t end = std::min(i + 8, count); i < end; ++i)
            if (world.changes[i] != PairChange::None) visit(static_cast<uint32_t>(i));
    }
}

// Wakes a body, the island it sleeps in and what is joined to them; their colliders are queued for FindPairs.
void WakeBody(WorldState& world, uint32_t body);
// Wakes what enabled joints hold to the body, which itself may be one that does not sleep.
void WakeJoined(WorldState& world, uint32_t body);
// Has FindPairs search for the body's pairs anew.
void RequeueColliders(WorldState& world, uint32_t body);
// Removes a joint; its bodies wake.
void RemoveJoint(WorldState& world, uint32_t joint);
// Wakes what overlaps the bounds.
void WakeInside(WorldState& world, const Bounds& bounds);

}  // namespace fulcrum
