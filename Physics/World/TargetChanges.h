// Targets of accuracy, and their changes: what a joint has exceeded counts for the old one. Called by the setters of
// the public interface; one thread.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <algorithm>

namespace fulcrum {

// AccuracyTarget::penetration of two bodies with these targets of their own, 0 if they have none.
inline float PenetrationTargetOf(float a, float b, float system) {
    if (a > 0 && b > 0) return std::min(a, b);
    return a > 0 || b > 0 ? std::max(a, b) : system;
}

void ChangePenetrationTarget(WorldState& world, uint32_t body, float target);
void ChangeErrorTarget(WorldState& world, uint32_t joint, float target);
// Of the world's settings, after a change of which efforts are chosen anew in any case.
void ChangeAccuracy(WorldState& world, const AccuracyTarget& accuracy);

}  // namespace fulcrum
