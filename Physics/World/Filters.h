// Which bodies may collide: layers and joints, filters, the contact listener. They are evaluated when FindPairs finds
// two colliders that have no pair yet; never again for a pair that exists, so that filters cost a step nothing. Where
// they change, the pairs that they forbid are removed here, and those that they allow are found by the next search.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <array>

namespace fulcrum {

// Whether category, mask and group of two bodies let them collide.
bool FiltersAllow(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB);
// Whether the contact listener, or null, lets them.
bool ListenerAllows(const ContactListener* listener, const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB);

// Whether two bodies are to collide at all,
inline bool CanCollide(const SystemSettings& settings, const BodyStore& bodies, const JointStore& joints,
                       uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = bodies.dynamics[bodyA];
    const BodyDynamics& b = bodies.dynamics[bodyB];
    if (bodyA == bodyB) return false;
    if (a.motion != MotionType::Dynamic && b.motion != MotionType::Dynamic) return false;
    if (!(settings.layerCollides[a.layer] >> b.layer & 1u)) return false;
    if ((a.special || b.special) && !FiltersAllow(bodies, bodyA, bodyB)) return false;
    return !joints.ForbidsContact(bodyA, bodyB);
}
// and one of them is awake, and neither disperses while the other is dynamic (Stages/Crowd.h).
inline bool MayCollide(const SystemSettings& settings, const BodyStore& bodies, const JointStore& joints,
                       uint32_t bodyA, uint32_t bodyB) {
    const BodyDynamics& a = bodies.dynamics[bodyA];
    const BodyDynamics& b = bodies.dynamics[bodyB];
    if ((a.dispersing && b.motion == MotionType::Dynamic) || (b.dispersing && a.motion == MotionType::Dynamic))
        return false;
    return (a.awake || b.awake) && CanCollide(settings, bodies, joints, bodyA, bodyB);
}

// Removes the pairs of a body that its filters no longer allow; their bodies wake.
void RemoveForbiddenPairs(WorldState& world, uint32_t body);
// After the settings got other layerCollides than `before`: removes pairs that these forbid, has those found that they
// allow.
void RefilterLayers(WorldState& world, const std::array<uint32_t, 32>& before);
// Replaces the listener, by none where null; all contacts are as the materials give them until it is
// asked.
void ChangeListener(WorldState& world, const ContactListener* listener);

}  // namespace fulcrum
