// Manifolds of all active pairs. A pair whose bodies hardly moved relative to each other keeps its manifold, of
// which Prepare brings the separations up to date. Contacts reach as far ahead as the bodies may move within the step,
// so that nothing is driven into the other by a whole step's motion before it is seen: in every direction, since what
// is hit is deflected and turned.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// Whether fat bounds still overlap; asked only where they changed.
bool Overlap(const WorldState& world, const Pair& pair) {
    return world.colliders.colliders[pair.colliderA].fat.Overlaps(world.colliders.colliders[pair.colliderB].fat);
}

// Whether the outer spheres of two bodies are farther apart than `distance`.
bool BallsApart(const WorldState& world, const Pair& pair, float distance) {
    const Vector3 between = (world.bodies.CenterOf(pair.bodyB) - world.bodies.CenterOf(pair.bodyA)).cast<float>();
    const float reach = pair.shapeA->OuterRadius() + pair.shapeB->OuterRadius() + distance;
    return LengthSquared(between) > reach * reach;
}

// m: how much closer the balls about two pieces may come within the step, also where something stops one of them at its
// start.
float ClosingMotion(const WorldState& world, const Pair& pair, float dt) {
    const BodyStore& bodies = world.bodies;
    Vector3 vA = bodies.LinearVelocityOf(pair.bodyA), vB = bodies.LinearVelocityOf(pair.bodyB);
    if (pair.offset) {
        const auto ofArm = [&](uint32_t body, uint32_t collider) {
            return Cross<float>(bodies.AngularVelocityOf(body),
                                Rotate(bodies.RotationOf(body), LocalOf(world, collider).position));
        };
        vA += ofArm(pair.bodyA, pair.colliderA);
        vB += ofArm(pair.bodyB, pair.colliderB);
    }
    float fastest = std::max(LengthSquared(Vector3(vB - vA)), LengthSquared(vB));
    if (!pair.fixedB) fastest = std::max(fastest, LengthSquared(vA));
    return dt * Sqrt(fastest);
}

// m: how much farther two pieces may reach by turning within the step: convex ones no farther than their outer balls.
// Of a surface that turns it is what is near the other that counts.
float TurningMotion(const WorldState& world, const Pair& pair, float dt) {
    const auto angleOf = [&](uint32_t body) { return dt * Length(world.bodies.AngularVelocityOf(body)); };
    const auto ofConvex = [&](uint32_t body, const Shape& shape) {
        const float outer = shape.OuterRadius();
        return std::min(angleOf(body) * outer, outer - shape.InnerRadius());
    };
    const float ofA = ofConvex(pair.bodyA, *pair.shapeA);
    if (pair.shapeB->IsConvex()) return ofA + ofConvex(pair.bodyB, *pair.shapeB);
    const float angle = angleOf(pair.bodyB);
    if (!(angle > 0)) return ofA;
    const Vector3 between = (world.bodies.CenterOf(pair.bodyB) - world.bodies.CenterOf(pair.bodyA)).cast<float>();
    return ofA + angle * std::min(pair.shapeB->OuterRadius(), Length(between) + pair.shapeA->OuterRadius());
}

// m: contacts farther ahead than this are left to the Continuous stage.
float MotionBeforeCast(const WorldState& world, const Pair& pair) {
    float motion = std::numeric_limits<float>::infinity();
    if (world.bodies.dynamics[pair.bodyA].continuous)
        motion = FreeMotion(pair.shapeA->InnerRadius(), pair.shapeA->OuterRadius());
    if (world.bodies.dynamics[pair.bodyB].continuous)
        motion = std::min(motion, FreeMotion(pair.shapeB->InnerRadius(), pair.shapeB->OuterRadius()));
    return motion;
}

PairChange CollidePair(WorldState& world, std::span<PairChange> changes, uint32_t index, float dt,
                       WorkerFindings& findings) {
    Pair& pair = world.pairs.pairs[index];
    const BodyPose& poseA = world.bodies.poses[pair.bodyA];
    const BodyPose& poseB = world.bodies.poses[pair.bodyB];
    const uint32_t now = static_cast<uint32_t>(world.step);
    if ((poseA.boundsChangedIn == now || poseB.boundsChangedIn == now) && !Overlap(world, pair))
        return PairChange::Dead;

    const float closing = FarEndFactor(world, pair) * ClosingMotion(world, pair, dt);
    const float mostMotion =
        world.bodies.continuousCount > 0 ? MotionBeforeCast(world, pair) : std::numeric_limits<float>::infinity();
    const auto reachOf = [&](float motion) {
        return SpeculativeDistance(world.settings, pair) + std::min(motion, mostMotion);
    };
    if (!pair.surface && pair.pointCount == 0 && !pair.offset && BallsApart(world, pair, reachOf(closing)))
        return PairChange::None;
    const float reachAhead = reachOf(closing + TurningMotion(world, pair, dt));
    if (pair.surface) return CollideWithSurface(world, changes, index, reachAhead, dt, findings);
    const PairView view = ViewPair(world.bodies, world.colliders, world.pairs, index);
    if (pair.pointCount > 0 && HardlyMoved(view)) {
        ++findings.kept;
    } else {
        CollideSettings settings;
        settings.method = world.settings.narrowPhase;
        settings.speculativeDistance = reachAhead;
        Manifold manifold;
        if (pair.shapeB->Type() == ShapeType::Plane)
            Collide(*pair.shapeA, static_cast<const Plane&>(*pair.shapeB), view.bInA, settings, pair.cache, manifold,
                    findings.libccd);
        else
            Collide(*pair.shapeA, static_cast<const ConvexShape&>(*pair.shapeB),
                    WithDistinctCenters(world, pair, view.bInA), settings, pair.cache, manifold, findings.libccd);
        WriteManifold(world, view, manifold, dt);
        pair.reference = view.bInA;
    }
    if (pair.pointCount > 0) NoteOverlap(world, index, view.bInA, findings);
    const PairChange change = NoteTouching(world, index, findings);
    return TouchesSleeper(world, pair) ? PairChange::WakesOther : change;
}

// What the next pairs need is fetched while this one is collided.
void PrefetchAhead(const WorldState& world, uint32_t index) {
    constexpr uint32_t kAhead = 6;
    if (index + kAhead >= world.pairs.pairs.size()) return;
    const Pair& pair = world.pairs.pairs[index + kAhead];
    for (uint32_t body : {pair.bodyA, pair.bodyB}) {
        __builtin_prefetch(&world.bodies.poses[body]);
        __builtin_prefetch(&world.bodies.states[body]);
    }
}

void CollideActive(WorldState& world, float dt, std::vector<PairChange>& changes, std::span<WorkerFindings> workers) {
    const IndexSet& active = world.pairs.active;
    changes.resize(world.pairs.pairs.size(), PairChange::None);
    world.jobs->ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                PrefetchAhead(world, index);
                if (world.pairs.pairs[index].isMore) return;  // comes with its pair
                changes[index] = CollidePair(world, changes, index, dt, workers[range.worker]);
            });
    });
}

void CollideActivated(WorldState& world, float dt, PairUpdates& updates, std::span<WorkerFindings> workers) {
    updates.changes.resize(world.pairs.pairs.size(), PairChange::None);
    world.jobs->ParallelFor(static_cast<uint32_t>(updates.activated.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t index = updates.activated[i];
            updates.changes[index] = CollidePair(world, updates.changes, index, dt, workers[range.worker]);
        }
    });
}

// Wakes the sleeping bodies that are to wake. Returns whether there are any.
bool WakeSleepers(WorldState& world, std::span<PairChange> changes) {
    bool woke = false;
    VisitChanges(changes, [&](uint32_t index) {
        if (changes[index] != PairChange::WakesOther) return;
        const Pair& pair = world.pairs.pairs[index];
        WakeBody(world, pair.bodyA);
        if (!pair.fixedB) WakeBody(world, pair.bodyB);
        changes[index] = pair.touching ? PairChange::Began : PairChange::None;
        woke = true;
    });
    return woke;
}

}  // namespace

void Collide(WorldState& world, float dt, PairUpdates& updates, CrowdState& crowd, std::span<WorkerFindings> workers,
             ScratchArena& scratch, StepReport& report) {
    CollideActive(world, dt, updates.changes, workers);
    AddMoreManifolds(world, dt, updates, workers);
    // What wakes searches for pairs of its own at once: what is hit must not lose its support for a step.
    while (WakeSleepers(world, updates.changes)) {
        FindPairs(world, updates, crowd, workers, scratch);
        if (updates.activated.empty()) break;
        CollideActivated(world, dt, updates, workers);
        AddMoreManifolds(world, dt, updates, workers);
    }
    GatherCrowd(world.bodies, crowd, workers);
    for (const WorkerFindings& f : workers) {
        report.contacts += f.contacts;
        report.contactPoints += f.points;
        report.keptManifolds += f.kept;
    }
}

}  // namespace fulcrum
