// Continuous collision: what moved far in this step is cast along its way. Where it hits, it bounces there and then, and goes on with
// what is left of the step. In rounds: all casts in parallel; then the hits in the order of their times, as long as both bodies' courses
// still are those that were cast; what changed its course, or lost its partner, is cast again.
#include <Fulcrum/Physics/Stages/Impact.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// Whoever hits something in each of so many rounds stays where it hit last until the next step.
constexpr int kRounds = 8;

// m: a body with continuous collision that moves less in a step is not cast.
float FreeMotionOf(const WorldState& world, uint32_t body) {
    const BodyCold& cold = world.bodies.cold[body];
    float least = std::numeric_limits<float>::infinity();
    for (uint32_t i = cold.firstCollider; i < cold.firstCollider + cold.colliderCount; ++i) {
        const Shape& shape = *world.colliders.shapes[i].shape;
        least = std::min(least, FreeMotion(shape.InnerRadius(), shape.OuterRadius()));
    }
    return least;
}

// Bounds reach ahead by the velocity that a body had when the step began. One that the solver moved elsewhere is given bounds about
// its whole way, so that the trees find it there.
void IncludeWays(WorldState& world) {
    const float least = 0.5f * world.settings.speculativeDistance;
    const std::vector<uint32_t>& awake = world.bodies.awake;
    world.jobs->ParallelFor(static_cast<uint32_t>(awake.size()), 256, [&](JobRange range) {
        for (uint32_t k = range.begin; k < range.end; ++k) {
            const uint32_t body = awake[k];
            const SweepStore::Start& start = world.sweeps.starts[body];
            if (start.step != world.report.step) continue;
            const Vector3 moved = (world.bodies.CentreOf(body) - start.pose.position).cast<float>();
            if (LengthSquared(moved) <= least * least) continue;
            const BodyCold& cold = world.bodies.cold[body];
            for (uint32_t i = cold.firstCollider; i < cold.firstCollider + cold.colliderCount; ++i)
                if (!world.colliders.colliders[i].fat.Contains(TightBoundsOf(world, i))) world.findings[range.worker].colliders.push_back(i);
        }
    });
    const size_t first = world.colliders.moved.size();
    std::vector<uint32_t>& moved = world.colliders.moved;
    for (WorkerFindings& findings : world.findings) {
        for (uint32_t collider : findings.colliders) world.colliders.Queue(collider);
        for (uint32_t collider : findings.colliders) {
            Collider& c = world.colliders.colliders[collider];
            c.fat.Include(TightBoundsOf(world, collider));
            world.colliders.TreeOf(c).Update(collider, c.fat);
        }
        findings.colliders.clear();
    }
    std::sort(moved.begin() + static_cast<ptrdiff_t>(first), moved.end());
}

void FindSwept(WorldState& world) {
    SweepStore& store = world.sweeps;
    store.places.resize(world.bodies.Size(), SweepStore::kNone);
    for (std::vector<uint32_t>* list : {&store.active, &store.next}) list->reserve(2 * size_t{store.users});
    store.swept.reserve(store.users);
    store.hits.reserve(store.users);
    for (WorkerFindings& findings : world.findings) findings.sweepHits.reserve(store.users);
    store.swept.clear();
    store.ended.clear();
    store.endedAt.clear();
    for (uint32_t body : world.bodies.awake) {
        const BodyDynamics& d = world.bodies.dynamics[body];
        if (!d.continuous || d.frozen || store.starts[body].step != world.report.step) continue;
        Sweep sweep = SweepOf(world, body);
        sweep.turns = world.bodies.cold[body].continuous == ContinuousCollision::LinearAndAngular;
        const float distance = Length(sweep.displacement) + (sweep.turns ? Length(sweep.turn) * d.outerRadius : 0.0f);
        if (distance > FreeMotionOf(world, body)) store.swept.push_back(sweep);
    }
    // In the order of the bodies: `awake` has none that repeats.
    std::sort(store.swept.begin(), store.swept.end(), [](const Sweep& a, const Sweep& b) { return a.body < b.body; });
    for (uint32_t i = 0; i < store.swept.size(); ++i) store.places[store.swept[i].body] = i;
}

void CastAll(WorldState& world) {
    SweepStore& store = world.sweeps;
    world.jobs->ParallelFor(static_cast<uint32_t>(store.active.size()), 8, [&](JobRange range) {
        WorkerFindings& findings = world.findings[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            SweepHit hit;
            if (CastSweep(world, store.swept[store.active[i]], findings, hit)) findings.sweepHits.push_back(hit);
        }
    });
    store.hits.clear();
    for (WorkerFindings& findings : world.findings) {
        store.hits.insert(store.hits.end(), findings.sweepHits.begin(), findings.sweepHits.end());
        findings.sweepHits.clear();
    }
    std::sort(store.hits.begin(), store.hits.end(), [](const SweepHit& a, const SweepHit& b) {
        return a.time < b.time || (a.time == b.time && a.body < b.body);
    });
}

class HitResolver {
public:
    HitResolver(WorldState& world, const StepContext& step, bool isLast) : world_(world), dt_(step.dt), isLast_(isLast) {}

    void Resolve(const SweepHit& hit) {
        SweepStore& store = world_.sweeps;
        const uint32_t place = store.places[hit.body], otherPlace = store.places[hit.other];
        Sweep& sweep = store.swept[place];
        if (sweep.changed) return;  // it is in the next round already
        if (otherPlace != SweepStore::kNone && store.swept[otherPlace].changed) {
            if (isLast_) Stop(sweep, hit.time);
            else store.next.push_back(place);
            return;
        }
        ImpactVelocities v;
        const bool parts = hit.pointCount > 0 && Part(hit, v);
        if (isLast_ || (hit.pointCount > 0 && !parts)) {
            Stop(sweep, hit.time);
        } else {
            Continue(place, hit.time, v.linear[0], v.angular[0], parts);
        }
        if (parts && otherPlace != SweepStore::kNone) {
            if (isLast_) Stop(store.swept[otherPlace], hit.time);
            else Continue(otherPlace, hit.time, v.linear[1], v.angular[1], true);
        }
    }

private:
    // What gravity and forces add to the velocity from a time on; nothing where the solver has spread it over the step.
    Vector3 Gain(uint32_t body, float time) const {
        if (!world_.bodies.CanMove(body) || world_.colouring.IsTouched(body)) return Vector3::Zero();
        const float* a = world_.bodies.poses[body].acceleration;
        return Vector3(a[0], a[1], a[2]) * ((1 - time) * dt_);
    }

    // Gives the bodies the velocities after the hit; `v` becomes those.
    bool Part(const SweepHit& hit, ImpactVelocities& v) {
        const uint32_t bodies[2] = {hit.body, hit.other};
        WakeBody(world_, hit.other);
        Vector3 gain[2];
        for (int s = 0; s < 2; ++s) {
            gain[s] = Gain(bodies[s], hit.time);
            v.linear[s] = world_.bodies.LinearVelocityOf(bodies[s]) - gain[s];
            v.angular[s] = world_.bodies.AngularVelocityOf(bodies[s]);
        }
        if (!SolveImpact(world_, hit, v)) return false;
        ++world_.report.sweptHits;
        for (int s = 0; s < 2; ++s) {
            if (!world_.bodies.CanMove(bodies[s])) continue;
            if (!IsFinite(v.linear[s]) || !IsFinite(v.angular[s])) return false;
            world_.bodies.SetVelocity(bodies[s], v.linear[s] + gain[s], v.angular[s]);
            world_.bodies.dynamics[bodies[s]].slowSeconds = 0;
        }
        return true;
    }

    void End(Sweep& sweep, float time) {
        world_.sweeps.ended.push_back(sweep);
        world_.sweeps.endedAt.push_back(time);
        sweep.start = sweep.PoseAt(time);
        sweep.from = time;
        sweep.isCut = sweep.changed = true;
    }

    // Nothing moves but what can: a kinematic body goes on as it is told.
    void Stop(Sweep& sweep, float time) {
        if (!world_.bodies.CanMove(sweep.body)) return;
        End(sweep, time);
        sweep.displacement.setZero();
        sweep.turn.setZero();
    }

    void Continue(uint32_t place, float time, const Vector3& linear, const Vector3& angular, bool parts) {
        Sweep& sweep = world_.sweeps.swept[place];
        const Vector3 displacement = sweep.DisplacementRate() * (1 - time), turn = sweep.TurnRate() * (1 - time);
        End(sweep, time);
        sweep.displacement = displacement;
        sweep.turn = turn;
        if (parts && world_.bodies.CanMove(sweep.body)) {
            const float rest = (1 - time) * dt_;
            sweep.displacement = (linear + Gain(sweep.body, time) * 0.5f) * rest;
            sweep.turn = angular * rest;
            Vector3 none = Vector3::Zero();
            world_.bodies.dynamics[sweep.body].Lock(sweep.displacement, none);
        }
        world_.sweeps.next.push_back(place);
    }

    WorldState& world_;
    float dt_;
    bool isLast_;
};

void Finish(WorldState& world) {
    SweepStore& store = world.sweeps;
    for (const Sweep& sweep : store.swept) {
        if (sweep.isCut && world.bodies.CanMove(sweep.body)) world.bodies.SetCentrePose(sweep.body, sweep.PoseAt(1));
        store.places[sweep.body] = SweepStore::kNone;
    }
}

}  // namespace

void Continuous(WorldState& world, const StepContext& step) {
    SweepStore& store = world.sweeps;
    if (store.users == 0) return;
    store.dt = step.dt;
    IncludeWays(world);
    FindSwept(world);
    world.report.sweptBodies = static_cast<uint32_t>(store.swept.size());
    store.active.resize(store.swept.size());
    for (uint32_t i = 0; i < store.active.size(); ++i) store.active[i] = i;
    for (int round = 0; round < kRounds && !store.active.empty(); ++round) {
        CastAll(world);
        store.next.clear();
        HitResolver resolver(world, step, round + 1 == kRounds);
        for (const SweepHit& hit : store.hits) resolver.Resolve(hit);
        for (const SweepHit& hit : store.hits)
            for (uint32_t body : {hit.body, hit.other})
                if (store.places[body] != SweepStore::kNone) store.swept[store.places[body]].changed = false;
        std::sort(store.next.begin(), store.next.end());
        store.next.erase(std::unique(store.next.begin(), store.next.end()), store.next.end());
        store.active.swap(store.next);
    }
    Finish(world);
}

}  // namespace fulcrum
