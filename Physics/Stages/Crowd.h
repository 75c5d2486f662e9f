// Bodies that stand in one another, hundreds at one point even: which way each goes, and which of them push each other first.
// Used by FindPairs and Collide, from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

// A point in the unit ball that follows from the body's index. Where centers coincide no shape tells which way is out; then each
// body counts as a hair away from where it is, towards its point. All pairs agree about that, so that bodies at one place leave
// it in all directions, next to those that they will lie beside.
Vector3 PlaceInCrowd(uint32_t body);

// `bInA` of two convex pieces, moved by that hair where their centers coincide.
RelativePose WithDistinctCenters(const WorldState& world, const Pair& pair, const RelativePose& bInA);

// Two bodies whose centers are nearer than this, as a part of the sum of their inner radii, stand in each other, as nothing does that
// was not put there.
inline constexpr float kDeepNearness = 0.8f;

// A collider as the search for its nearest sees it.
struct CrowdPlace {
    Position center = Position::Zero();  // m, a hair from where it is
    float innerRadius = 0;               // m; negative: what does not stand in others: it is not dynamic
};
CrowdPlace CrowdPlaceOf(const WorldState& world, uint32_t collider);
// How near two colliders are, as a part of the sum of their inner radii; infinite unless both are dynamic.
float Nearness(const CrowdPlace& a, const CrowdPlace& b);

// Notes in `findings` which bodies of a pair stand in each other, if they do; `bInA` is that of the pieces.
void NoteStanding(const WorldState& world, uint32_t pair, const RelativePose& bInA, WorkerFindings& findings);

// Marks the bodies that stand in many others, until they overlap nothing. Of those each is pushed by many, all as hard as a single
// overlap would be, and the sum would shoot it out. So pushes move them no faster than contactPushSpeed, and leave them no more
// speed than they had without: the solver asks for BodyDynamics::crowded where it integrates.
void NoteCrowd(WorldState& world);

// Limits the velocity with which a crowded body is about to move for h seconds: pushes may change it by contactPushSpeed. While it stands
// in many, by less if its place is near the middle of the ball: a crowd grows as a whole and not as a shell. Nor is it
// pressed into what does not move: the contacts with that are soft, too, and would give way to so many.
void LimitPush(WorldState& world, uint32_t body, float h);

// `v` with at most the length of `limit`.
inline Vector3 NoFasterThan(const Vector3& v, const Vector3& limit) {
    const float squared = LengthSquared(v), most = LengthSquared(limit);
    return squared > most ? Vector3(v * std::sqrt(most / squared)) : v;
}

}  // namespace fulcrum
