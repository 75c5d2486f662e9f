// Continuous collision: what moved far in this step is cast along its way. Where it hits, it bounces there and then, and goes on with
// what is left of the step. In rounds: all casts in parallel; then the hits in the order of their times, as long as both bodies' courses
// still are those that were cast; what changed its course, or lost its partner, is cast again.
#include <Fulcrum/Physics/Stages/Impact.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>

#include <algorithm>
#include <limits>
#include <tuple>

namespace fulcrum {

namespace {

// Whoever hits something in each of so many rounds stays where it hit last until the next step.
constexpr int kRounds = 8;

// m: a body with continuous collision that moves less in a step is not cast.
float FreeMotionOf(const WorldState& world, uint32_t body) {
    float least = std::numeric_limits<float>::infinity();
    VisitColliders(world, body, [&](uint32_t i) {
        const Shape& shape = *world.colliders.shapes[i].shape;
        least = std::min(least, FreeMotion(shape.InnerRadius(), shape.OuterRadius()));
    });
    return least;
}

// Whether the fat bounds of a body's colliders, which reach ahead by the velocity that it had when the step began, hold all its way.
// Those that do not are noted, to be enlarged.
bool StaysInBounds(const WorldState& world, uint32_t body, const Vector3& moved, float dt, WorkerFindings& findings) {
    const float* a = world.bodies.poses[body].acceleration;
    const float slack = 0.5f * world.settings.speculativeDistance;
    const bool flewAsForeseen = !world.colouring.IsTouched(body) && LengthSquared(Vector3(a[0], a[1], a[2])) * dt * dt * dt * dt < slack * slack;
    if (flewAsForeseen || LengthSquared(moved) <= slack * slack) return true;
    bool stays = true;
    VisitColliders(world, body, [&](uint32_t i) {
        if (world.colliders.colliders[i].fat.Contains(TightBoundsOf(world, i))) return;
        findings.colliders.push_back(i);
        stays = false;
    });
    return stays;
}

// Pieces beside the centre of mass change sides of a wall where the body turns, so that compounds are always cast with their turn.
bool IsCastTurning(const WorldState& world, uint32_t body) {
    const BodyCold& cold = world.bodies.cold[body];
    return cold.continuous == ContinuousCollision::LinearAndAngular || !cold.shape->IsConvex();
}

void LookAtBody(const WorldState& world, uint32_t body, float dt, WorkerFindings& findings) {
    using SearchBy = SweepStore::SearchBy;
    const SweepStore::Start& start = world.sweeps.starts[body];
    const BodyDynamics& d = world.bodies.dynamics[body];
    if (start.step != world.report.step || d.frozen) return;
    const Vector3 moved = (world.bodies.CentreOf(body) - start.pose.position).cast<float>();
    const bool stays = StaysInBounds(world, body, moved, dt, findings);
    if (!d.continuous) return;
    const bool turns = IsCastTurning(world, body);
    const float distance = Length(moved) + (turns ? Length(SweepOf(world, body).turn) * d.outerRadius : 0.0f);
    if (!(distance > FreeMotionOf(world, body))) return;
    findings.fast.push_back({body, stays && !turns ? SearchBy::Pairs : SearchBy::Trees});
}

// What the solver moved elsewhere than its bounds foresaw is given bounds about its whole way, so that the trees find it there.
void EnlargeBounds(WorldState& world) {
    std::vector<uint32_t>& moved = world.colliders.moved;
    const size_t first = moved.size();
    for (WorkerFindings& findings : world.findings) {
        for (uint32_t collider : findings.colliders) {
            world.colliders.Queue(collider);
            Collider& c = world.colliders.colliders[collider];
            c.fat.Include(TightBoundsOf(world, collider));
            world.colliders.TreeOf(c).Update(collider, c.fat);
        }
        findings.colliders.clear();
    }
    std::sort(moved.begin() + static_cast<ptrdiff_t>(first), moved.end());
}

void FindFast(WorldState& world, float dt) {
    SweepStore& store = world.sweeps;
    const std::vector<uint32_t>& awake = world.bodies.awake;
    world.jobs->ParallelFor(static_cast<uint32_t>(awake.size()), 64, [&](JobRange range) {
        for (uint32_t k = range.begin; k < range.end; ++k) LookAtBody(world, awake[k], dt, world.findings[range.worker]);
    });
    EnlargeBounds(world);
    store.fast.clear();
    for (WorkerFindings& findings : world.findings) {
        store.fast.insert(store.fast.end(), findings.fast.begin(), findings.fast.end());
        findings.fast.clear();
    }
    std::sort(store.fast.begin(), store.fast.end(), [](const auto& a, const auto& b) { return a.body < b.body; });
    // To look through all pairs for a few bodies would take longer than their searches.
    constexpr size_t kPairsPerSearch = 16;
    const bool few = store.fast.size() * kPairsPerSearch < world.pairs.active.Size();
    for (SweepStore::FastBody& fast : store.fast) {
        if (few) fast.by = SweepStore::SearchBy::Trees;
        store.searchBy[fast.body] = fast.by;
    }
}

// Of the collider of a pair that is to be cast against the other; kNone: neither.
uint32_t CasterOf(const WorldState& world, const Pair& pair) {
    using SearchBy = SweepStore::SearchBy;
    const SearchBy a = world.sweeps.searchBy[pair.bodyA], b = world.sweeps.searchBy[pair.bodyB];
    if (a == SearchBy::Trees || b == SearchBy::Trees) return SweepStore::kNone;  // finds the other by itself
    return a == SearchBy::Pairs ? pair.colliderA : b == SearchBy::Pairs ? pair.colliderB : SweepStore::kNone;
}

void CastPairs(WorldState& world) {
    const IndexSet& active = world.pairs.active;
    world.jobs->ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        WorkerFindings& findings = world.findings[range.worker];
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                const Pair& pair = world.pairs.pairs[index];
                const uint32_t caster = pair.isMore ? SweepStore::kNone : CasterOf(world, pair);
                SweepHit hit;
                if (caster == SweepStore::kNone || !CastPair(world, caster, pair.colliderA ^ pair.colliderB ^ caster, findings, hit)) return;
                findings.sweepHits.push_back(hit);
            });
    });
}

void CastActive(WorldState& world) {
    SweepStore& store = world.sweeps;
    world.jobs->ParallelFor(static_cast<uint32_t>(store.active.size()), 8, [&](JobRange range) {
        WorkerFindings& findings = world.findings[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            SweepHit hit;
            if (CastSweep(world, store.swept[store.active[i]], findings, hit)) findings.sweepHits.push_back(hit);
        }
    });
}

void SortHits(WorldState& world) {
    std::vector<SweepHit>& hits = world.sweeps.hits;
    hits.clear();
    for (WorkerFindings& findings : world.findings) {
        hits.insert(hits.end(), findings.sweepHits.begin(), findings.sweepHits.end());
        findings.sweepHits.clear();
    }
    std::sort(hits.begin(), hits.end(), [](const SweepHit& a, const SweepHit& b) {
        return std::tie(a.time, a.body, a.otherCollider) < std::tie(b.time, b.body, b.otherCollider);
    });
}

// The place of a fast body's course in `swept`, where it comes to be when it is first asked for.
uint32_t PlaceOf(WorldState& world, uint32_t body) {
    SweepStore& store = world.sweeps;
    if (store.searchBy[body] == SweepStore::SearchBy::None) return SweepStore::kNone;
    if (store.places[body] == SweepStore::kNone) {
        Sweep sweep = SweepOf(world, body);
        sweep.turns = IsCastTurning(world, body);
        store.places[body] = static_cast<uint32_t>(store.swept.size());
        store.swept.push_back(sweep);
    }
    return store.places[body];
}

class HitResolver {
public:
    HitResolver(WorldState& world, const StepContext& step, bool isLast) : world_(world), dt_(step.dt), isLast_(isLast) {}

    void Resolve(const SweepHit& hit) {
        const uint32_t place = PlaceOf(world_, hit.body), otherPlace = PlaceOf(world_, hit.other);
        std::vector<Sweep>& swept = world_.sweeps.swept;
        Sweep& sweep = swept[place];
        if (sweep.changed) return;  // it is in the next round, or stays where it is
        if (otherPlace != SweepStore::kNone && swept[otherPlace].changed) {
            if (isLast_) {
                Stop(sweep, hit.time);
            } else {
                sweep.changed = true;
                world_.sweeps.next.push_back(place);
            }
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
            if (isLast_) Stop(swept[otherPlace], hit.time);
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
            const BodyDynamics& d = world_.bodies.dynamics[bodies[s]];
            if (!d.spherical) world_.bodies.UpdateInertia(bodies[s], AxesOf(d, SweepOf(world_, bodies[s]).PoseAt(hit.time).rotation));
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

// The lists get room by the number of those that may need it.
void ReserveLists(WorldState& world) {
    SweepStore& store = world.sweeps;
    const size_t users = store.users;
    store.searchBy.resize(world.bodies.Size(), SweepStore::SearchBy::None);
    store.places.resize(world.bodies.Size(), SweepStore::kNone);
    store.fast.reserve(users);
    store.swept.reserve(users);
    store.hits.reserve(2 * users);
    for (std::vector<uint32_t>* list : {&store.active, &store.next}) list->reserve(2 * users);
    for (WorkerFindings& findings : world.findings) {
        findings.fast.reserve(users);
        findings.sweepHits.reserve(users);
    }
}

void StartCourses(WorldState& world) {
    SweepStore& store = world.sweeps;
    store.active.clear();
    for (const SweepStore::FastBody& fast : store.fast)
        if (fast.by == SweepStore::SearchBy::Trees) store.active.push_back(PlaceOf(world, fast.body));
    world.report.sweptBodies = static_cast<uint32_t>(store.fast.size());
}

// Those that hits have changed, or left undecided, are searched in the next round.
void EndRound(SweepStore& store) {
    for (Sweep& sweep : store.swept) sweep.changed = false;
    std::sort(store.next.begin(), store.next.end());
    store.next.erase(std::unique(store.next.begin(), store.next.end()), store.next.end());
    store.active.swap(store.next);
    store.next.clear();
}

void Finish(WorldState& world) {
    SweepStore& store = world.sweeps;
    for (const Sweep& sweep : store.swept) {
        if (sweep.isCut && world.bodies.CanMove(sweep.body)) world.bodies.SetCentrePose(sweep.body, sweep.PoseAt(1));
        store.places[sweep.body] = SweepStore::kNone;
    }
    for (const SweepStore::FastBody& fast : store.fast) store.searchBy[fast.body] = SweepStore::SearchBy::None;
}

}  // namespace

void Continuous(WorldState& world, const StepContext& step) {
    SweepStore& store = world.sweeps;
    store.swept.clear();
    store.ended.clear();
    store.endedAt.clear();
    if (store.users == 0) return;
    store.dt = step.dt;
    ReserveLists(world);
    FindFast(world, step.dt);
    if (store.fast.empty()) return;
    StartCourses(world);
    const bool usesPairs = store.active.size() < store.fast.size();
    for (int round = 0; round < kRounds && (!store.active.empty() || (round == 0 && usesPairs)); ++round) {
        if (round == 0 && usesPairs) CastPairs(world);
        CastActive(world);
        SortHits(world);
        HitResolver resolver(world, step, round + 1 == kRounds);
        for (const SweepHit& hit : store.hits) resolver.Resolve(hit);
        EndRound(store);
    }
    Finish(world);
}

}  // namespace fulcrum
