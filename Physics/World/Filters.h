// Which bodies may collide: layers and joints, filters, the contact listener. The answers make pairs, or none, when
// FindPairs meets two colliders anew; a pair that exists is never asked about again, so that filters cost a step
// nothing. Where an answer changes, the pairs that it forbids are removed here, and those that it allows are found by
// the search that follows.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <array>

namespace fulcrum {

// Whether category, mask and group of two bodies let them collide.
bool FiltersAllow(const WorldState& world, uint32_t bodyA, uint32_t bodyB);
// Whether the contact listener, if any, lets them.
bool ListenerAllows(const WorldState& world, uint32_t bodyA, uint32_t bodyB);

// Whether contacts between two bodies are wanted,
inline bool CanCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = world.bodies.dynamics[bodyA];
    const BodyDynamics& b = world.bodies.dynamics[bodyB];
    if (bodyA == bodyB) return false;
    if (a.motion != MotionType::Dynamic && b.motion != MotionType::Dynamic) return false;
    if (!(world.settings.layerCollides[a.layer] >> b.layer & 1u)) return false;
    if ((a.filtered || b.filtered) && !FiltersAllow(world, bodyA, bodyB)) return false;
    return !world.joints.ForbidsContact(bodyA, bodyB);
}
// and one of them is awake, and neither disperses while the other is dynamic (Stages/Crowd.h).
inline bool MayCollide(const WorldState& world, uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = world.bodies.dynamics[bodyA];
    const BodyDynamics& b = world.bodies.dynamics[bodyB];
    if ((a.dispersing && b.motion == MotionType::Dynamic) || (b.dispersing && a.motion == MotionType::Dynamic))
        return false;
    return (a.awake || b.awake) && CanCollide(world, bodyA, bodyB);
}

// Removes the pairs of a body that its filters no longer allow; their bodies wake.
void RemoveForbiddenPairs(WorldState& world, uint32_t body);
// After the settings got other layerCollides than `before`: removes pairs that these forbid, has those found that they
// allow.
void RefilterLayers(WorldState& world, const std::array<uint32_t, 32>& before);
// Has another listener, or none (null), say what collides; all contacts are as the materials give them until it is
// asked.
void ChangeListener(WorldState& world, const ContactListener* listener);

}  // namespace fulcrum
