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

// How near the centers of two colliders are, as a part of the sum of their inner radii; infinite unless both may be pushed. Two
// that are nearer than this stand in each other, as nothing does that was not put there.
inline constexpr float kDeepNearness = 0.8f;
float Nearness(const WorldState& world, uint32_t colliderA, uint32_t colliderB);

}  // namespace fulcrum
