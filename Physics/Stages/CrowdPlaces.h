// Where the bodies of a crowd disperse to (Crowd.h): places in a ball that has room for all, as far as floor and walls
// allow. Used by StartDispersing; PointInBall by contacts of coincident bodies, too. One thread.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>
#include <vector>

namespace fulcrum {

// m/s, of the bodies that move to the surface of the ball; all others are slower. Faster than contacts push, as nothing
// is in their way.
inline float DispersingSpeed(const SystemSettings& settings) { return 1.5f * settings.contactPushSpeed; }

// A point in the unit ball that looks random and follows from the body's index alone; all indices together fill the
// ball uniformly.
Vector3 PointInBall(uint32_t body);

// A floor or wall, seen from the middle of a ball: allows places with normal . place >= offset.
struct PlaceLimit {
    Vector3 normal;
    float offset;  // in radii of the ball
};
// `count` points of a lattice that fill a ball about the origin as densely as equal spheres can be packed, from the
// innermost to the outermost. The ball's radius is 1 without limits, and larger where these cut parts of it off; empty:
// they leave too little.
std::vector<Vector3> PlacesInBall(uint32_t count, std::span<const PlaceLimit> limits = {});

// Adds an entry to `dispersing` for each of `bodies`, none of which has joints: their places, and how long they take to
// get there. Bodies near one point get places about their common middle, others about where they are. Reorders
// `bodies`.
void AssignPlaces(const CollisionView& view, std::span<uint32_t> bodies, std::vector<DispersingBody>& dispersing);

}  // namespace fulcrum
