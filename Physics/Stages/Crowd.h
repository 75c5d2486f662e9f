// Crowds: many bodies created in one place, thousands at one point even. A few are separated by their contacts. Among
// many no contact normal tells which way is out, n bodies have n^2 pairs, and the sum of their pushes would throw them
// far apart. So a body that deeply overlaps many others disperses: for some time it does not collide with dynamic
// bodies, gravity does not act on it, and on top of its own velocity it moves, at a bounded speed, to a place of its
// own in a ball that has room for all, or in what floor and walls leave of that ball. Those that started together end
// together, when nearly all of them overlap no other. From then on contacts separate what is left,
// at depenetrationSpeed.
//   CrowdOverlaps.h  which bodies overlap many others
//   CrowdPlaces.h    where bodies disperse to
//   Crowd.h          start, motion and end of dispersing
//   CrowdContacts.h  contacts of coincident bodies, and of bodies that were put into each other
// Used by UpdateBounds, FindPairs and Store; one thread, but for OwnVelocity. Costs nothing while no body disperses.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Of the bodies in CrowdState::deepOverlaps, in any order, those that deeply overlap many others start to disperse.
// They lose their pairs with dynamic bodies, of which `changes` knows nothing more. The list is empty afterwards.
void StartDispersing(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                     BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring, CrowdState& crowd,
                     std::span<PairChange> changes, const StepWorkers& workers);

// As the step begins, before bounds: dispersing bodies get the velocity with which they move in this step.
void PushDispersing(const StepContext& step, const ColliderStore& colliders, const PairStore& pairs, BodyStore& bodies,
                    std::vector<DispersingBody>& all, JobSystem& jobs);
// As it ends, for a dispersing body: its velocity v, m/s, without that push.
// For different bodies from any number of threads.
Vector3 OwnVelocity(const BodyStore& bodies, std::span<const DispersingBody> all, uint32_t body, const Vector3& v,
                    float dt);

// Bodies that have dispersed are removed from `all`, collide again, and search for their pairs.
void EndDispersing(const StepContext& step, const JointStore& joints, const PairStore& pairs, BodyStore& bodies,
                   ColliderStore& colliders, std::vector<DispersingBody>& all, const StepWorkers& workers);

}  // namespace fulcrum
