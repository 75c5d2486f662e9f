// Torque-free rotation of bodies about their center of mass, conserving angular momentum. Called by the Store stage,
// for different bodies from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>

namespace fulcrum {

struct FreeTurn {
    const BodyDynamics* body = nullptr;
    Quaternion rotation;                        // unit; in: at the start, out: at the end
    Vector3 angularVelocity = Vector3::Zero();  // rad/s; in: at the start, out: at the end
    Vector3 torque = Vector3::Zero();           // N m, constant
};

// Whether two of a body's principal moments are equal, so that its rotation has a closed form.
bool IsSymmetric(const BodyDynamics& body);

// Rotates any body for dt seconds; backwards if dt is negative.
void RotateFreely(FreeTurn& turn, float dt);

// Rotates `count` symmetric bodies, 1..kTurnsTogether, in lanes: bit-identical to one at a time.
inline constexpr int kTurnsTogether = 4;
void RotateTogether(FreeTurn* const (&turns)[kTurnsTogether], int count, float dt);

}  // namespace fulcrum
