// The largest speeds of all, and what shortens a vector to a length. Any thread.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Math/Vector.h>

namespace fulcrum {

// No body is faster, whatever its own limits. Its displacement in a step still fits the arithmetic of the narrow phase,
// and its turn is still a number of which more than the whole part is known.
inline constexpr float kFastestLinear = 3e8f;   // m/s
inline constexpr float kFastestAngular = 1e6f;  // rad/s

// Shortens a finite v to `limit` if it is longer, and says so; |v| may be beyond the floats.
bool LimitLength(Vector3& v, float limit);

// A finite force, torque or impulse, shortened where times `inverse` (of a mass, or the trace of inertia's) it makes
// more than any speed or acceleration that counts.
Vector3 LimitedPush(const Vector3& push, double inverse);
inline double Trace(const BodyMass& mass) {
    return double{mass.inverseInertia[0]} + double{mass.inverseInertia[1]} + double{mass.inverseInertia[2]};
}

}  // namespace fulcrum
