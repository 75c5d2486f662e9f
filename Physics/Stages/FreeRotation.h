// Bodies that turn freely about their center of mass for a step and keep their angular momentum. Called by the Store
// stage, for different bodies from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>

namespace fulcrum {

struct FreeTurn {
    const BodyDynamics* body = nullptr;
    Quaternion rotation;                        // unit; becomes that at the end
    Vector3 angularVelocity = Vector3::Zero();  // rad/s; becomes that at the end
    Vector3 torque = Vector3::Zero();           // N m, all along
};

// Whether two of a body's principal moments are equal, so that its motion is known in closed form.
bool IsSymmetric(const BodyDynamics& body);

// Any body, for dt seconds; back in time where dt is negative.
void RotateFreely(FreeTurn& turn, float dt);

// `count` symmetric bodies, 1 .. kTurnsTogether: at little more cost than one, the same bits.
inline constexpr int kTurnsTogether = 4;
void RotateTogether(FreeTurn* const (&turns)[kTurnsTogether], int count, float dt);

}  // namespace fulcrum
