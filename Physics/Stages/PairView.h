// Input of the narrow phase for a pair, and functions that store its results. Used by Collide and CollideSurface, for
// different pairs from any number of threads at once.
#pragma once

#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/PairShapes.h>

namespace fulcrum {

struct PairView {
    Pair& pair;
    PairShapes shapes;
    RelativePose bodyBInA;  // relative pose of the bodies' center frames
    RelativePose bInA;      // relative pose of the shapes' center frames
};

// The stores that the Collide stage reads, and the pairs, the only one that it writes.
struct CollideStores {
    const StepContext& step;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const JointStore& joints;
    const ConstraintColoring& coloring;
    PairStore& pairs;
    // s since the start of the step, if pairs collide again within it (Recollide.h).
    float elapsed = 0;
    // The second pass of Collide, over the pairs of bodies that contacts found in the first one will deflect: these,
    // and by body the index of its own, or kNone.
    std::span<const Deflection> deflections{};
    std::span<const uint32_t> deflectionOf{};

    bool IsSecondPass() const { return !deflections.empty(); }
    const Deflection* DeflectionOf(uint32_t body) const {
        return !IsSecondPass() || deflectionOf[body] == PairStore::kNone ? nullptr : &deflections[deflectionOf[body]];
    }

    // Of the bodies' center frames at that time. Relative positions do not depend on the distance from the origin.
    Quaternion RotationOf(uint32_t body) const;
    Vector3 OffsetOf(uint32_t bodyA, uint32_t bodyB) const;  // m, from A to B, world axes
};

// At the poses of the start of the step, and at those of the stores' time.
PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t pair);
PairView ViewPair(const CollideStores& stores, uint32_t pair);

// Factor of the speculative distance relative to the motion in the step. A body that is hit at one end rotates, so that
// its other end gets faster: for a rod up to twice as fast. So the factor is larger for bodies that touch something,
// and 1 for others, which therefore move in exact free flight until the step in which they hit.
float FarEndFactor(const ConstraintColoring& coloring, const Pair& pair);

// How near the shapes of a pair must be to have contacts in this step: the speculative distance and their possible
// motion.
class PairReach {
public:
    PairReach(const CollideStores& stores, const Pair& pair, PairShapes shapes);
    // Whether the bounding spheres of the two bodies are farther apart.
    bool AreFarApart(const CollideStores& stores, const Pair& pair, PairShapes shapes) const;
    // m
    float WithRotation(const CollideStores& stores, const Pair& pair, PairShapes shapes) const;

private:
    float Of(float motion) const { return speculative_ + std::min(motion, mostMotion_); }
    float speculative_, closing_, mostMotion_;
};

// The manifold of a pair without a surface.
void FindManifold(const CollideStores& stores, const PairView& view, float reach, Manifold& manifold,
                  WorkerFindings& findings);
// Those of a pair with one, to findings.surface.
void FindSurfaceManifolds(const CollideStores& stores, const PairView& view, uint32_t pair, float reach,
                          WorkerFindings& findings);
// Writes these to the pair and its additional manifolds. writesEmpty: manifolds that were not found lose their points.
// Those without a slot are left in findings.surfaceLeft, as indices.
void WriteSurfaceManifolds(const CollideStores& stores, const PairView& view, uint32_t pair, bool writesEmpty,
                           WorkerFindings& findings);

// Whether the manifolds found at contact.reference are still valid.
bool HardlyMoved(const PairView& view, const PairContact& contact);

// Whether a contact that pressed would change direction, of a child of a compound: its impulses are dropped then, and
// those of other children that pressed the opposite way must be, too, or they would throw the compound out.
bool TurnsFromOthers(const CollideStores& stores, const PairView& view, const Manifold& manifold);

// Writes the result of the narrow phase to the pair's contact and record. Impulses are kept for points with matching
// feature ids, unless the normal turns. Points farther apart than the speculative distance are kept only if they can
// touch within the step. Adds the bodies that the contact will deflect to findings.deflections.
void WriteManifold(const CollideStores& stores, const PairView& view, const Manifold& manifold, PairContact& contact,
                   ContactRecord& record, WorkerFindings& findings);

// Updates the manifolds of a pair with a surface. Writes the changes of additional manifolds to `changes`, and returns
// that of the first. Manifolds without a slot are added to findings.more.
PairChange CollideWithSurface(const CollideStores& stores, std::span<PairChange> changes, uint32_t pair,
                              const PairReach& reach, WorkerFindings& findings);

// Creates slots for those, serially, in the order of the pairs.
void AddMoreManifolds(const CollideStores& stores, PairUpdates& updates, std::span<WorkerFindings> workers);

// Counts a contact that the first pass has found already: nothing else is new of it in the second one. Returns false if
// it has none.
bool IsFoundAgain(const CollideStores& stores, const Pair& pair, WorkerFindings& findings);
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
