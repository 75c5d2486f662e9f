// Speed limits that hold for all bodies, and clamping of vectors to a length. Any thread.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Math/Vector.h>

namespace fulcrum {

// Upper bounds for all bodies, whatever their own limits. Displacements in a step then fit the arithmetic of the narrow
// phase, and rotation angles, floats, are precise to fractions of a radian.
inline constexpr float kFastestLinear = 3e8f;   // m/s
inline constexpr float kFastestAngular = 1e6f;  // rad/s

// Clamps the length of a finite v to `limit`, and returns whether it was longer; |v| may overflow a float.
bool LimitLength(Vector3& v, float limit);

// A finite force, torque or impulse, clamped to what still makes a difference: times `inverse` (the inverse mass, or
// the trace of the inverse inertia) it exceeds every possible speed or acceleration.
Vector3 LimitedPush(const Vector3& push, double inverse);
inline double Trace(const BodyMass& mass) {
    return double{mass.inverseInertia[0]} + double{mass.inverseInertia[1]} + double{mass.inverseInertia[2]};
}

}  // namespace fulcrum
