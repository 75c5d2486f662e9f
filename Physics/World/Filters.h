// Which bodies may collide: layers and joints, filters, the contact listener. Filters are evaluated when FindPairs
// finds two colliders without a pair, but not for existing pairs, so that they cost nothing per step. When filters
// change, forbidden pairs are removed here, and newly allowed ones are found by the next search.
#pragma once

#include <Fulcrum/Physics/World/WorldState.h>

#include <array>
#include <span>

namespace fulcrum {

// Whether category, mask and group of two bodies allow a collision.
bool FiltersAllow(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB);
// Whether the contact listener (may be null) allows it.
bool ListenerAllows(const ContactListener* listener, const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB);

// Whether two bodies may collide,
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

// Removes those of the pairs that filters no longer allow; their bodies wake.
void RemoveForbiddenPairs(WorldState& world, std::span<const uint32_t> pairs);
// After a change of layerCollides from `before`: removes forbidden pairs, and has newly allowed ones searched for.
void RefilterLayers(WorldState& world, const std::array<uint32_t, 32>& before);
// Replaces the listener (null: none); all contacts have their materials' properties until it is called.
void ChangeListener(WorldState& world, const ContactListener* listener);

}  // namespace fulcrum
