// Bodies that stand in one another, thousands at one point even. A few are parted by their contacts; where many stand in each other
// no contact tells which way is out, all pairs of n bodies are n^2, and the sum of their pushes would shoot everything out. So a
// body that stands in many others disperses: it meets no dynamic body, does not fall, and moves at a bounded speed of its own along
// a way of its own. Ways lead to places in a ball, or what the floor leaves of it, that grows until nearly all that started together
// overlap nobody; those in between would only be in each other's way. What is not foreseen, as moving platforms, reflects ways. From
// then on contacts part what is left, and push no faster than a bounded speed until nothing overlaps.
// Used by UpdateBounds, FindPairs, Collide, Solve and Store. Costs nothing where nobody disperses.
#pragma once

#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

// A point in the unit ball that follows from the body's index. Where centers coincide no shape tells which way is out; then each
// body counts as a hair away from where it is, towards its point. All pairs agree about that, so that bodies at one place leave
// it in all directions, next to those that they will lie beside.
Vector3 PlaceInCrowd(uint32_t body);

// `bInA` of two convex pieces, moved by that hair where their centers coincide.
RelativePose WithDistinctCenters(const WorldState& world, const Pair& pair, const RelativePose& bInA);

// What does not move, seen from the middle of a ball: places have normal . place > offset.
struct PlaceLimit {
    Vector3 normal;
    float offset;  // as a part of the radius of a ball with all places
};
// So many points that fill a ball about the origin as densely as balls can be packed, from the innermost to the outermost; its radius is
// one where there are no limits, and more where these leave no room for some. Empty: they leave too little.
std::vector<Vector3> PlacesInBall(uint32_t count, std::span<const PlaceLimit> limits = {});

// As the step begins, before bounds: what disperses gets the velocity with which it moves in this step.
void PushDispersing(WorldState& world, float dt);
// As it ends: the velocity of a body that disperses, without that.
Vector3 OwnVelocity(const WorldState& world, uint32_t body, const Vector3& v, float dt);

// Whether two colliders of dynamic bodies stand in each other, as nothing does that was not put there: their centers are far nearer
// than the sum of their inner radii.
bool StandInEachOther(const WorldState& world, uint32_t collider, uint32_t other);

// Of `bodies`, in any order, those that stand in many others start to disperse. They lose their pairs with dynamic bodies.
void StartDispersing(WorldState& world, std::vector<uint32_t>& bodies);
// Those that started together have dispersed when nearly all of them have room, and search for their pairs.
void EndDispersing(WorldState& world);

// Notes in `findings` which bodies of a pair stand in each other, if they do; `bInA` is that of the pieces.
void NoteStanding(const WorldState& world, uint32_t pair, const RelativePose& bInA, WorkerFindings& findings);
// Gathers what was noted. Pushes of bodies that disperse, or have dispersed and still overlap something, move them no faster than
// contactPushSpeed, and leave them no more speed than they had without: the solver asks for BodyDynamics::crowded where it integrates.
void NoteCrowd(WorldState& world);

// Limits the velocity with which a crowded body is about to move for h seconds: pushes may change it by contactPushSpeed. Nor is it
// pressed into what does not move: the contacts with that are soft, too, and would give way to so many.
void LimitPush(WorldState& world, uint32_t body, float h);

// `v` with at most the length of `limit`.
inline Vector3 NoFasterThan(const Vector3& v, const Vector3& limit) {
    const float squared = LengthSquared(v), most = LengthSquared(limit);
    return squared > most ? Vector3(v * std::sqrt(most / squared)) : v;
}

}  // namespace fulcrum
