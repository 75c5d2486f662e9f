// The world: bodies, colliders, pairs, joints, sensors. Functions that change several of them are in files beside this
// one. Independent of the stages and the interfaces.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/ColliderStore.h>
#include <Fulcrum/Physics/World/CollidersOutsideFatBounds.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/Lifts.h>
#include <Fulcrum/Physics/World/PairStore.h>
#include <Fulcrum/Physics/World/PendingTrees.h>
#include <Fulcrum/Physics/World/SeenPoses.h>
#include <Fulcrum/Physics/World/SensorStore.h>
#include <Fulcrum/Physics/World/SleepingIslands.h>
#include <Fulcrum/Physics/World/WorldLock.h>

#include <memory>

namespace fulcrum {

class ContactListener;
class CallObserver;
class StepObserver;

struct WorldState {
    FULCRUM_WORLD_MEMORY
    explicit WorldState(MemoryResource* memory) : lock(memory) {}

    SystemSettings settings;
    std::unique_ptr<WorldJobs> jobs;
    const ContactListener* listener = nullptr;
    StepObserver* observer = nullptr;
    CallObserver* callObserver = nullptr;

    BodyStore bodies;
    ColliderStore colliders;
    PairStore pairs;
    JointStore joints;
    ConstraintColoring coloring;
    SleepingIslands sleeping;
    SensorStore sensors;

    Array<uint32_t> removed;  // bodies to forget before the next step
    uint64_t step = 0;        // number of steps begun

    // Lock for queries.
    WorldLock lock;
    CollidersOutsideFatBounds outsideFatBounds;
    PendingTrees pendingTrees;
    SeenPoses seenPoses;
    uint64_t heededShapeVersion = 0;  // see ShapeEdits.h
    LiftStore lifts;
};

size_t HeapBytes(const WorldState& world);

// Calls visit(collider) for the colliders of a body.
template <class Visitor>
void VisitColliders(const BodyStore& bodies, const ColliderStore& colliders, uint32_t body, Visitor&& visit) {
    const BodyCold& cold = bodies.cold[body];
    const auto visitRun = [&](uint32_t first, uint32_t count) {
        for (uint32_t i = first; i < first + count; ++i)
            if (colliders.shapes[i].shape) visit(i);
    };
    visitRun(cold.firstCollider, cold.colliderCount);
    for (uint32_t run = cold.MoreColliders(); run != ColliderStore::kNone; run = colliders.runs[run].next)
        visitRun(colliders.runs[run].first, colliders.runs[run].count);
}
template <class Visitor>
void VisitColliders(const WorldState& world, uint32_t body, Visitor&& visit) {
    VisitColliders(world.bodies, world.colliders, body, visit);
}

// The index of a collider's child in its body's shape.
inline uint32_t ChildOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider) {
    const BodyCold& cold = bodies.cold[colliders.colliders[collider].body];
    uint32_t before = 0;
    ColliderRun run{cold.firstCollider, cold.colliderCount, cold.MoreColliders()};
    while (collider - run.first >= run.count) {
        before += run.count;
        run = colliders.runs[run.next];
    }
    return before + (collider - run.first);
}

// The collider's center frame in that of its body.
inline RelativePose LocalOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider) {
    const ColliderShape& piece = colliders.shapes[collider];
    if (!piece.onOrigin) return piece.local;
    return {piece.local.position + bodies.cold[colliders.colliders[collider].body].children->origin,
            piece.local.rotation};
}

// World pose of the shape's own frame.
inline Pose ColliderPoseOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider) {
    const Pose body = bodies.CenterPoseOf(colliders.colliders[collider].body);
    return colliders.shapes[collider].offset ? body * LocalOf(bodies, colliders, collider) : body;
}

// The shape with its pose in its body's center frame.
inline ColliderShape PieceOf(const BodyStore& bodies, const ColliderStore& colliders, uint32_t collider) {
    ColliderShape piece = colliders.shapes[collider];
    piece.local = LocalOf(bodies, colliders, collider);
    return piece;
}

// Whether a body has a single collider, permanently.
inline bool IsOnePiece(const BodyStore& bodies, uint32_t body) {
    const BodyCold& cold = bodies.cold[body];
    return cold.colliderCount == 1 && !cold.children;
}

// Makes the world record between steps what the enabled events need.
void KeepForEvents(WorldState& world);

}  // namespace fulcrum
