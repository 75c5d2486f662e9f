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

// Of a body that rotates about two world axes only: its angular velocity, rad/s, after its rotation has changed. A lock
// exerts torque about its own axis alone, which does no work and leaves the angular momentum about the other two, but
// not their inertia. Momentum keeps its direction; its magnitude follows from the energy, which is kept exactly.
Vector3 VelocityAboutTwoAxes(const BodyDynamics& body, const Quaternion& before, const Quaternion& after,
                             const Vector3& angularVelocity);
// Rotates such a body for dt seconds, without torque.
void RotateAboutTwoAxes(FreeTurn& turn, float dt);

}  // namespace fulcrum
