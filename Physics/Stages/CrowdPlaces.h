// Target positions of dispersing bodies (Crowd.h) in a ball large enough for all, as far as floors and walls allow.
// Used by StartDispersing; PointInBall also by contacts of coincident bodies. One thread.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// m/s, of bodies that move to the surface of the ball; all others are slower. Faster than penetration recovery, since
// they do not collide.
inline float DispersingSpeed(const SystemSettings& settings) { return 1.5f * settings.contactPushSpeed; }

// A pseudo-random point in the unit ball computed from the body's index; the points of all indices fill the ball
// uniformly.
Vector3 PointInBall(uint32_t body);

// A floor or wall relative to the center of a ball: allows positions with normal . position >= offset.
struct PlaceLimit {
    Vector3 normal;
    float offset;  // in radii of the ball
};
// `count` points of a densest sphere packing in a ball about the origin, from the innermost to the outermost. The
// ball's radius is 1 without limits, larger if limits cut off parts of it. Empty if they leave too little space.
Array<Vector3> PlacesInBall(uint32_t count, std::span<const PlaceLimit> limits = {});

// Adds an entry to `dispersing` for each of `bodies`, none of which has joints: its target position and travel time.
// Bodies near one point get positions about their common center, others about their own position. Reorders `bodies`.
void AssignPlaces(const CollisionView& view, std::span<uint32_t> bodies, Array<DispersingBody>& dispersing);

}  // namespace fulcrum
