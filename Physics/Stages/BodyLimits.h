// Keeps the state of bodies within bounds: clamps speeds to their limits and forces to those with a finite
// acceleration, and freezes bodies whose state is not finite. For different bodies from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

namespace fulcrum {

// Clamps a body's velocities, which must be finite, to its speed limits. Returns whether to count the body as clamped:
// once per step, and only if the change exceeds rounding.
[[nodiscard]] bool ShortenSpeeds(BodyStore& bodies, uint32_t body, Vector3& v, Vector3& w);
// False if not finite.
inline bool IsWithinSpeeds(const BodyDynamics& d, const Vector3& v, const Vector3& w) {
    return LengthSquared(v) <= d.maxLinearSpeed * d.maxLinearSpeed &&
           LengthSquared(w) <= d.maxAngularSpeed * d.maxAngularSpeed;
}
[[nodiscard]] inline bool LimitSpeeds(BodyStore& bodies, uint32_t body, Vector3& v, Vector3& w) {
    return !IsWithinSpeeds(bodies.dynamics[body], v, w) && ShortenSpeeds(bodies, body, v, w);
}

// Validates an awake body at the start of a step: freezes it if its state is not finite, clamps velocities and forces.
void AdmitBody(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings);

// Stops a body at its last valid pose and treats it as static until SetPose.
void Freeze(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings);
// Stops a body for this step, because the velocity computed by constraints is not finite.
void Stop(BodyStore& bodies, uint32_t body, WorkerFindings& findings);
}  // namespace fulcrum
