// Input of the narrow phase for a pair, and functions that store its results. Used by Collide and CollideSurface, for
// different pairs from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

struct PairView {
    Pair& pair;
    RelativePose bodyBInA;  // relative pose of the bodies' center frames
    RelativePose bInA;      // relative pose of the shapes' center frames
};
PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t pair);

// The stores that the Collide stage reads, and the pairs, the only one that it writes.
struct CollideStores {
    const StepContext& step;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const JointStore& joints;
    const ConstraintColoring& coloring;
    PairStore& pairs;
};

// Factor of the speculative distance relative to the motion in the step. A body that is hit at one end rotates, so that
// its other end gets faster: for a rod up to twice as fast. So the factor is larger for bodies that touch something,
// and 1 for others, which therefore move in exact free flight until the step in which they hit.
float FarEndFactor(const ConstraintColoring& coloring, const Pair& pair);

// Whether the manifolds found at contact.reference are still valid.
bool HardlyMoved(const PairView& view, const PairContact& contact);

// Writes the result of the narrow phase to the pair's contact and record. Impulses are kept for points with matching
// feature ids. Points farther apart than the speculative distance are kept only if they can touch within the step.
void WriteManifold(const CollideStores& stores, const PairView& view, const Manifold& manifold, PairContact& contact,
                   ContactRecord& record);

// Updates the manifolds of a pair with a surface; `reach`, m: the speculative distance. Writes the changes of
// additional manifolds to `changes`, and returns that of the first. Manifolds without a slot are added to
// findings.more.
PairChange CollideWithSurface(const CollideStores& stores, std::span<PairChange> changes, uint32_t pair, float reach,
                              WorkerFindings& findings);

// Creates slots for those, serially, in the order of the pairs.
void AddMoreManifolds(const CollideStores& stores, PairUpdates& updates, std::span<WorkerFindings> workers);

// Determines the change of a manifold in this step, after calling the listener.
PairChange NoteTouching(const CollideStores& stores, uint32_t pair, WorkerFindings& findings);
// Calls the listener for a manifold with points and applies its changes; returns false if the contact is ignored.
bool AskListener(const ContactListener& listener, const BodyStore& bodies, const ColliderStore& colliders,
                 PairStore& pairs, uint32_t pair);
// The listener's changes of a contact with this default friction and restitution, validated to be in range and finite.
ContactChange AskAbout(const ContactListener& listener, const ContactView& contact, float friction, float restitution);
// View of a manifold at the poses of the Collide stage, its points in `room`; and the same after the step.
ContactView ViewContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs, uint32_t pair,
                        ContactView::Point (&room)[ContactRecord::kMaxPoints]);
ContactView ViewSolvedContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                              uint32_t pair, ContactView::Point (&room)[ContactRecord::kMaxPoints]);
// Whether one of its bodies sleeps and wakes if they touch.
bool TouchesSleepingBody(const BodyStore& bodies, const Pair& pair);

}  // namespace fulcrum
