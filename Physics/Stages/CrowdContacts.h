// Contacts of bodies that were put into each other: which way coincident ones are pushed, and which bodies are crowded.
// Crowded are bodies that disperse (Crowd.h), and those that overlap what they were created, placed or grown in, or
// still touch such a body. Their contacts push at depenetrationSpeed at most, and they keep no speed of that: many
// pushes add up, and relaxing passes leave a part of it in the velocities. Used by Collide, Prepare, Solve and Store,
// for different bodies from any number of threads, but for GatherCrowd.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

#include <cmath>

namespace fulcrum {

// Where the centers of two convex shapes coincide, no direction is better than another to separate them along. Then
// each body counts as a thousandth of the inner radii away from where it is, towards its PointInBall: all pairs of a
// crowd agree about that, and its bodies are pushed out in all directions. Returns `bInA`, that of the shapes, with
// that offset where it is needed.
RelativePose WithDistinctCenters(const BodyStore& bodies, const ColliderStore& colliders, const Pair& pair,
                                 const RelativePose& bInA);

// Notes in `findings` which bodies of a pair overlap deeply, and which are crowded, or still are. bInA: of the shapes.
void NoteOverlap(const SystemSettings& settings, const BodyStore& bodies, const JointStore& joints,
                 const PairStore& pairs, uint32_t pair, const RelativePose& bInA, WorkerFindings& findings);
// Gathers what the workers noted into `crowd`, and marks the crowded bodies. One thread.
void GatherCrowd(BodyStore& bodies, CrowdState& crowd, std::span<WorkerFindings> workers);

// Limits the velocity with which a dispersing body is about to move for h seconds: contacts and joints change it by no
// more than contactPushSpeed, and it is not pressed into immovable bodies, whose soft contacts would yield to the
// pushes of so many.
void LimitPush(const SystemSettings& settings, const ColliderStore& colliders, const PairStore& pairs,
               BodyStore& bodies, uint32_t body, float h);

// `v` with at most the length of `limit`: pushes leave a crowded body no more speed than it had without them.
inline Vector3 NoFasterThan(const Vector3& v, const Vector3& limit) {
    const float squared = LengthSquared(v), most = LengthSquared(limit);
    return squared > most ? Vector3(v * std::sqrt(most / squared)) : v;
}

// World space, from body A to body B.
Vector3 ContactNormal(const BodyStore& bodies, const PairStore& pairs, uint32_t pair);

// Calls visit(pair) for the touching manifolds of a dynamic body with immovable bodies.
template <class Visitor>
void VisitImmovableContacts(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                            uint32_t body, Visitor&& visit) {
    VisitColliders(bodies, colliders, body, [&](uint32_t collider) {
        pairs.VisitOf(collider, [&](uint32_t first) {
            for (uint32_t pair = first; pair != PairStore::kNone; pair = pairs.pairs[pair].more)
                if (pairs.pairs[pair].fixedB && pairs.pairs[pair].touching) visit(pair);
        });
    });
}

}  // namespace fulcrum
