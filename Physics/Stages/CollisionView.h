// Read-only view of bodies, colliders and collision filters for searches and casts of the stages.
#pragma once

#include <Fulcrum/Physics/Stages/StepContext.h>
#include <Fulcrum/Physics/World/Filters.h>

namespace fulcrum {

struct CollisionView {
    const StepContext& step;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const JointStore& joints;  // joints may disable contacts between their bodies
};

inline bool CanCollide(const CollisionView& view, uint32_t bodyA, uint32_t bodyB) {
    return CanCollide(view.step.settings, view.bodies, view.joints, bodyA, bodyB);
}
inline bool MayCollide(const CollisionView& view, uint32_t bodyA, uint32_t bodyB) {
    return MayCollide(view.step.settings, view.bodies, view.joints, bodyA, bodyB);
}
inline bool ListenerAllows(const CollisionView& view, uint32_t bodyA, uint32_t bodyB) {
    return ListenerAllows(view.step.listener, view.bodies, bodyA, bodyB);
}

}  // namespace fulcrum
