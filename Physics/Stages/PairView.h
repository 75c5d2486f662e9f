// A pair as the Collide stage sees it, and how what the narrow phase finds is written down. Used by Collide and
// CollideSurface, for different pairs from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

struct PairView {
    Pair& pair;
    ContactRecord& record;
    RelativePose bodyBInA;       // of the bodies' center frames
    RelativePose bInA;           // of the pieces'
    const RelativePose& before;  // the same when the manifold was found
};
PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t pair);

// What the Collide stage reads, and the pairs, which alone it writes.
struct CollideStores {
    const StepContext& step;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const JointStore& joints;
    const ConstraintColoring& coloring;
    PairStore& pairs;
};

// A body that is hit at one end turns about there, so that its other end comes on faster than it did: a rod's by up to
// twice. Contacts of bodies that touch something are looked for so many times as far ahead as they move within the
// step; those of others once, so that what flies freely does so, exactly, up to the step in which it hits.
float FarEndFactor(const ConstraintColoring& coloring, const Pair& pair);

// Whether the manifolds that were found at pair.reference still do.
bool HardlyMoved(const PairView& view);

// Writes what the narrow phase found into the record. Impulses go on where the same features touch. Points that are
// farther apart than the speculative distance stay only if they can meet within the step.
void WriteManifold(const CollideStores& stores, const PairView& view, const Manifold& manifold);

// Brings the manifolds of a pair with a surface up to date; `reach`, m: how far apart shapes are seen. Says of each
// further manifold in `changes` what became of it, and returns that of the first. What has no place goes to
// findings.more.
PairChange CollideWithSurface(const CollideStores& stores, std::span<PairChange> changes, uint32_t pair, float reach,
                              WorkerFindings& findings);

// Makes places for those, serially, in the order of the pairs.
void AddMoreManifolds(const CollideStores& stores, PairUpdates& updates, std::span<WorkerFindings> workers);

// Notes what a manifold has come to in this step, once the listener was asked.
PairChange NoteTouching(const CollideStores& stores, uint32_t pair, WorkerFindings& findings);
// Asks the listener about a manifold with points and applies its changes; false: the contact is to be ignored.
bool AskListener(const ContactListener& listener, const BodyStore& bodies, const ColliderStore& colliders,
                 PairStore& pairs, uint32_t pair);
// What the listener wants of a contact that would have this friction and restitution. All of it is in range and finite.
ContactChange AskAbout(const ContactListener& listener, const ContactView& contact, float friction, float restitution);
// A manifold at the poses at which the Collide stage sees it, its points in `room`; and the same after the step.
ContactView ViewContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs, uint32_t pair,
                        ContactView::Point (&room)[ContactRecord::kMaxPoints]);
ContactView ViewSolvedContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                              uint32_t pair, ContactView::Point (&room)[ContactRecord::kMaxPoints]);
// Whether one of its bodies sleeps, and is to wake where they touch.
bool TouchesSleeper(const BodyStore& bodies, const Pair& pair);

}  // namespace fulcrum
