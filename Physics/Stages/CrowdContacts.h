// Contacts of bodies that were placed inside each other: separating directions of coincident ones, and which bodies are
// crowded. Crowded bodies are those that disperse (Crowd.h), those that overlap a body since they were created, placed
// or grown, and those that still touch such a body. Their contacts separate them at depenetrationSpeed at most, and
// they keep none of that velocity: many contacts add up, and relax iterations leave a part of it in the velocities.
// Jointed ones keep it, since their velocities are also those of their joints.
// Used by Collide, Prepare, Solve and Store, for different bodies from any number of threads, but for GatherCrowd.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/PairShapes.h>

#include <cmath>

namespace fulcrum {

struct CollideStores;

// If the centers of two convex shapes coincide, their separating direction is undefined. Then each body is treated as
// displaced by a thousandth of the inner radii towards its PointInBall: this is consistent for all pairs of a crowd,
// and its bodies are pushed out in all directions. Returns `bInA`, the relative pose of the shapes, with that offset if
// needed.
RelativePose WithDistinctCenters(const BodyStore& bodies, const ColliderStore& colliders, const Pair& pair,
                                 PairShapes shapes, const RelativePose& bInA);

// Records in `findings` which bodies of a pair overlap deeply, and which are crowded or still are. bInA: relative pose
// of the shapes.
void NoteOverlap(const CollideStores& stores, uint32_t pair, PairShapes shapes, const RelativePose& bInA,
                 WorkerFindings& findings);
// Merges the workers' findings into `crowd`, and marks the crowded bodies. One thread.
void GatherCrowd(const StepContext& step, BodyStore& bodies, CrowdState& crowd, std::span<WorkerFindings> workers);

// Limits the velocity with which a dispersing body moves for the next h seconds: contacts and joints change it by at
// most contactPushSpeed, and it is not pressed into immovable bodies, whose soft contacts would yield to so many
// bodies.
void LimitPush(const SystemSettings& settings, const ColliderStore& colliders, const PairStore& pairs,
               BodyStore& bodies, uint32_t body, float h);

// `v` clamped to the length of `limit`: recovery does not increase the speed of a crowded body.
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
            for (uint32_t pair = first; pair != PairStore::kNone; pair = pairs.MoreOf(pair))
                if (pairs.pairs[pair].fixedB && pairs.pairs[pair].touching) visit(pair);
        });
    });
}

}  // namespace fulcrum
