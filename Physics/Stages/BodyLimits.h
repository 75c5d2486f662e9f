// Keeps the numbers of bodies within bounds, whatever users, contacts and joints make of them: speeds up to the
// largest, forces that no float can turn into an acceleration, and bodies whose state is not finite, which are frozen.
// For different bodies from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

namespace fulcrum {

// Shortens a body's velocities, both finite, to its largest speeds. Returns whether the body is to be counted for it:
// once a step, where that took more than a rounding.
[[nodiscard]] bool ShortenSpeeds(BodyStore& bodies, uint32_t body, Vector3& v, Vector3& w);
// False for what is not finite.
inline bool IsWithinSpeeds(const BodyDynamics& d, const Vector3& v, const Vector3& w) {
    return LengthSquared(v) <= d.maxLinearSpeed * d.maxLinearSpeed &&
           LengthSquared(w) <= d.maxAngularSpeed * d.maxAngularSpeed;
}
[[nodiscard]] inline bool LimitSpeeds(BodyStore& bodies, uint32_t body, Vector3& v, Vector3& w) {
    return !IsWithinSpeeds(bodies.dynamics[body], v, w) && ShortenSpeeds(bodies, body, v, w);
}

// The first look at an awake body in a step: freezes what is not finite, shortens velocities and forces.
void AdmitBody(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings);

// Stops a body at its last good pose, and holds it there like a static one until it is placed anew.
void Freeze(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings);
// Stops a body for this step, because what constraints made of its motion is not finite.
void Stop(BodyStore& bodies, uint32_t body, WorkerFindings& findings);
}  // namespace fulcrum
