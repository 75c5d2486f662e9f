// Crowds: many bodies created at one place, even thousands at one point. A few are separated by their contacts. Among
// many, contact normals do not point out of the crowd, n bodies have n^2 pairs, and the sum of their recovery
// velocities would throw them far apart. So a body that deeply overlaps many others disperses: for some time it neither
// collides with dynamic bodies nor feels gravity, and in addition to its own velocity it moves, at a bounded speed, to
// a position of its own in a ball large enough for all, or in the part of the ball that floors and walls leave free.
// Bodies that started together end together, when nearly all of them overlap no other. From then on contacts separate
// the rest, at depenetrationSpeed.
//   CrowdOverlaps.h  which bodies overlap many others
//   CrowdPlaces.h    where bodies disperse to
//   Crowd.h          start, motion and end of dispersing
//   CrowdContacts.h  contacts of coincident bodies, and of bodies that were put into each other
// Used by UpdateBounds, FindPairs and Store; one thread, but for OwnVelocity. Costs nothing while no body disperses.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Bodies in CrowdState::deepOverlaps (in any order) that deeply overlap many others start to disperse. Their pairs with
// dynamic bodies are removed, also from `changes`. The list is empty afterwards.
void StartDispersing(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                     BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring, CrowdState& crowd,
                     std::span<PairChange> changes, const StepWorkers& workers);

// At the start of the step, before bounds: sets the velocity with which dispersing bodies move in this step.
void PushDispersing(const StepContext& step, const ColliderStore& colliders, const PairStore& pairs, BodyStore& bodies,
                    Array<DispersingBody>& all, JobSystem& jobs);
// At the end of the step, for a dispersing body: its velocity v, m/s, without the dispersing velocity.
// For different bodies from any number of threads.
Vector3 OwnVelocity(const BodyStore& bodies, std::span<const DispersingBody> all, uint32_t body, const Vector3& v,
                    float dt);

// Removes bodies that have dispersed from `all`; they collide again and search for pairs.
void EndDispersing(const StepContext& step, const JointStore& joints, const PairStore& pairs, BodyStore& bodies,
                   ColliderStore& colliders, Array<DispersingBody>& all, const StepWorkers& workers);

}  // namespace fulcrum
