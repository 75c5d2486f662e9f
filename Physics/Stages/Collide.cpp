// Manifolds of all active pairs. A pair whose bodies hardly moved relative to each other keeps its manifold, of
// which Prepare brings the separations up to date. Contacts reach as far ahead as the bodies may move within the step, so that nothing
// is driven into the other by a whole step's motion before it is seen.
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

// A manifold is kept up to this relative motion since it was found.
constexpr float kKeptDistance = 1e-3f;  // m, but at most this part of the smaller body:
constexpr float kKeptPart = 2e-3f;
constexpr float kKeptAngle = 1e-3f;     // rad

struct PairView {
    Pair& pair;
    ContactRecord& record;
    const ConvexShape& shapeA;
    const ConvexShape& shapeB;
    RelativePose bInA;  // of the pieces' centre frames
};

// Points are stored relative to the bodies, the narrow phase speaks of the pieces.
Vector3 ToBody(const WorldState& world, const Pair& pair, uint32_t collider, const Vector3& point) {
    return pair.offset ? world.colliders.shapes[collider].local.Transform(point) : point;
}

bool HardlyMoved(const PairView& v) {
    const RelativePose& old = v.pair.reference;
    const float size = std::min(v.shapeA.OuterRadius(), v.shapeB.OuterRadius());
    const float distance = std::min(kKeptDistance, kKeptPart * size);
    if (LengthSquared(Vector3(v.bInA.position - old.position)) > distance * distance) return false;
    // For small angles |q - q0| is half the angle; the sign of a quaternion does not flip between two steps.
    const Quaternion& a = v.bInA.rotation;
    const Quaternion& b = old.rotation;
    const Quaternion d{a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
    return LengthSquared(d) <= 0.25f * kKeptAngle * kKeptAngle;
}

void WriteTwistRadius(ContactRecord& record) {
    const Vector3 normal(record.normal[0], record.normal[1], record.normal[2]);
    const Vector3 t1 = Perpendicular(normal), t2 = Cross<float>(normal, t1);
    const int count = static_cast<int>(record.pointCount);
    Vector3 centre = Vector3::Zero();
    for (int i = 0; i < count; ++i) centre += Vector3(record.points[i].onA[0], record.points[i].onA[1], record.points[i].onA[2]);
    centre = centre * (1.0f / static_cast<float>(count));
    float x[ContactRecord::kMaxPoints], y[ContactRecord::kMaxPoints];
    for (int i = 0; i < count; ++i) {
        const Vector3 r = Vector3(record.points[i].onA[0], record.points[i].onA[1], record.points[i].onA[2]) - centre;
        x[i] = Dot<float>(r, t1);
        y[i] = Dot<float>(r, t2);
    }
    record.twistRadius = MeanDistance(x, y, count);
}

// Writes what the narrow phase found into the record. Impulses go on where the same features touch. Points that are farther
// apart than the speculative distance stay only if they can meet within the step.
void WriteManifold(const WorldState& world, const PairView& v, const RelativePose& bodyBInA, const Manifold& manifold,
                   float dt) {
    Pair& pair = v.pair;
    ContactRecord& record = v.record;
    float oldImpulses[Manifold::kMaxPoints];
    std::copy(record.impulse, record.impulse + Manifold::kMaxPoints, oldImpulses);
    const int oldCount = pair.pointCount;
    uint32_t oldFeatures[Manifold::kMaxPoints];
    std::copy(pair.features, pair.features + Manifold::kMaxPoints, oldFeatures);

    const Vector3 normal = pair.offset ? Rotate(world.colliders.shapes[pair.colliderA].local.rotation, manifold.normal)
                                       : manifold.normal;
    // Velocities of B relative to A, in A's frame.
    const BodyStore& bodies = world.bodies;
    const Quaternion toWorld = bodies.RotationOf(pair.bodyA);
    const auto inA = [&](const Vector3& world_) { return InverseRotate(toWorld, world_); };
    const Vector3 vA = inA(bodies.LinearVelocityOf(pair.bodyA)), wA = inA(bodies.AngularVelocityOf(pair.bodyA));
    const Vector3 vB = inA(bodies.LinearVelocityOf(pair.bodyB)), wB = inA(bodies.AngularVelocityOf(pair.bodyB));

    int count = 0;
    for (int i = 0; i < manifold.pointCount; ++i) {
        const ManifoldPoint& found = manifold.points[i];
        const Vector3 onA = ToBody(world, pair, pair.colliderA, found.positionOnA);
        const Vector3 meets = onA + normal * found.separation;  // on B, in A's frame
        const Vector3 velocity = vB + Cross<float>(wB, Vector3(meets - bodyBInA.position)) - vA - Cross<float>(wA, onA);
        const float approach = -Dot<float>(velocity, normal);
        if (found.separation > world.settings.speculativeDistance + std::max(approach, 0.0f) * dt) continue;
        const Vector3 onB = bodyBInA.InverseTransform(meets);
        for (int k = 0; k < 3; ++k) {
            record.points[count].onA[k] = onA[k];
            record.points[count].onB[k] = onB[k];
        }
        record.impulse[count] = 0;
        for (int j = 0; j < oldCount; ++j)
            if (oldFeatures[j] == found.feature) record.impulse[count] = oldImpulses[j];
        pair.features[count++] = found.feature;
    }
    for (int k = 0; k < 3; ++k) record.normal[k] = normal[k];
    record.pointCount = static_cast<float>(count);
    pair.pointCount = static_cast<uint8_t>(count);
    if (oldCount == 0) {
        record.twistImpulse = 0;
        for (float& f : record.frictionImpulse) f = 0;
    }
    if (count > 0) WriteTwistRadius(record);
}

// Whether fat bounds still overlap; asked only where they changed.
bool Overlap(const WorldState& world, const Pair& pair) {
    return world.colliders.colliders[pair.colliderA].fat.Overlaps(world.colliders.colliders[pair.colliderB].fat);
}

// Whether the outer spheres of two bodies are farther apart than `distance`.
bool BallsApart(const WorldState& world, const Pair& pair, float distance) {
    const Vector3 between = (world.bodies.CentreOf(pair.bodyB) - world.bodies.CentreOf(pair.bodyA)).cast<float>();
    const float reach = pair.shapeA->OuterRadius() + pair.shapeB->OuterRadius() + distance;
    return LengthSquared(between) > reach * reach;
}

PairChange CollidePair(WorldState& world, uint32_t index, float dt, WorkerFindings& findings) {
    Pair& pair = world.pairs.pairs[index];
    const BodyPose& poseA = world.bodies.poses[pair.bodyA];
    const BodyPose& poseB = world.bodies.poses[pair.bodyB];
    const uint32_t now = static_cast<uint32_t>(world.report.step);
    if ((poseA.boundsChangedIn == now || poseB.boundsChangedIn == now) && !Overlap(world, pair)) return PairChange::Dead;

    const float reachAhead = world.settings.speculativeDistance + dt * Length(Vector3(
        world.bodies.LinearVelocityOf(pair.bodyB) - world.bodies.LinearVelocityOf(pair.bodyA)));
    if (pair.pointCount == 0 && !pair.offset && BallsApart(world, pair, reachAhead)) return PairChange::None;
    const RelativePose bodyBInA = Relative(world.bodies.CentrePoseOf(pair.bodyA), world.bodies.CentrePoseOf(pair.bodyB));
    PairView v{pair, world.pairs.records[index], *pair.shapeA, *pair.shapeB, bodyBInA};
    if (pair.offset)
        v.bInA = Inverse(world.colliders.shapes[pair.colliderA].local) * bodyBInA * world.colliders.shapes[pair.colliderB].local;

    const bool touched = pair.touching;
    if (pair.pointCount > 0 && HardlyMoved(v)) {
        ++findings.kept;
    } else {
        CollideSettings settings;
        settings.method = world.settings.narrowPhase;
        settings.speculativeDistance = reachAhead;
        Manifold manifold;
        Collide(v.shapeA, v.shapeB, v.bInA, settings, pair.cache, manifold, findings.libccd);
        WriteManifold(world, v, bodyBInA, manifold, dt);
        pair.reference = v.bInA;
    }
    pair.touching = pair.pointCount > 0;
    if (pair.touching) {
        ++findings.contacts;
        findings.points += pair.pointCount;
        const auto sleeps = [&](uint32_t body) {
            const BodyDynamics& d = world.bodies.dynamics[body];
            return d.motion == MotionType::Dynamic && !d.awake;
        };
        if (sleeps(pair.bodyA) || sleeps(pair.bodyB)) return PairChange::WakesOther;
    }
    if (pair.touching == touched) return PairChange::None;
    return pair.touching ? PairChange::Began : PairChange::Ended;
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

void CollideActive(WorldState& world, float dt) {
    const IndexSet& active = world.pairs.active;
    world.changes.resize(world.pairs.pairs.size(), PairChange::None);
    world.jobs->ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                PrefetchAhead(world, index);
                world.changes[index] = CollidePair(world, index, dt, world.findings[range.worker]);
            });
    });
}

void CollideActivated(WorldState& world, float dt) {
    world.changes.resize(world.pairs.pairs.size(), PairChange::None);
    world.jobs->ParallelFor(static_cast<uint32_t>(world.activated.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t index = world.activated[i];
            world.changes[index] = CollidePair(world, index, dt, world.findings[range.worker]);
        }
    });
}

// Wakes the sleeping bodies that were touched. They search for pairs of their own at once: what is hit must not lose its
// support for a step. Returns whether that made pairs active, which are to be collided too.
bool WakeTouched(WorldState& world) {
    bool woke = false;
    VisitChanges(world, [&](uint32_t index) {
        if (world.changes[index] != PairChange::WakesOther) return;
        const Pair& pair = world.pairs.pairs[index];
        WakeBody(world, pair.bodyA);
        if (!pair.fixedB) WakeBody(world, pair.bodyB);
        world.changes[index] = PairChange::Began;
        woke = true;
    });
    world.activated.clear();
    if (woke) FindPairs(world);
    return !world.activated.empty();
}

}  // namespace

void Collide(WorldState& world, const StepContext& step) {
    CollideActive(world, step.dt);
    while (WakeTouched(world)) CollideActivated(world, step.dt);
    StepReport& report = world.report;
    for (const WorkerFindings& f : world.findings) {
        report.contacts += f.contacts;
        report.contactPoints += f.points;
        report.keptManifolds += f.kept;
        report.libccd.epaFailures += f.libccd.epaFailures;
        report.libccd.centreLineFallbacks += f.libccd.centreLineFallbacks;
    }
}

}  // namespace fulcrum
