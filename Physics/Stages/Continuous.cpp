// Continuous collision: what moved far in this step is cast along its path. Where it hits, it bounces there and then,
// and goes on with what is left of the step. In rounds: all casts in parallel; then the hits in the order of their
// times, as long as both bodies' sweeps still are those that were cast (ResolveHits.h); what changed its sweep, or lost
// its partner, is cast again.
#include <Fulcrum/Physics/Stages/ResolveHits.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// A body that hits something in each of so many rounds stays where it hit last until the next step.
constexpr int kRounds = 16;

// m: a body with continuous collision that moves less in a step is not cast.
float FreeMotionOf(const WorldState& world, uint32_t body) {
    float least = std::numeric_limits<float>::infinity();
    VisitColliders(world, body, [&](uint32_t i) {
        const Shape& shape = *world.colliders.shapes[i].shape;
        least = std::min(least, FreeMotion(shape.InnerRadius(), shape.OuterRadius()));
    });
    return least;
}

// Whether the fat bounds of a body's colliders, which reach ahead by the velocity that it had when the step began, hold
// its whole path. Those that do not are noted, to be enlarged.
bool StaysInBounds(const WorldState& world, uint32_t body, const Vector3& moved, float dt, WorkerFindings& findings) {
    const float* a = world.bodies.poses[body].acceleration;
    const BodyCold& cold = world.bodies.cold[body];
    // Pieces of a compound may be small.
    const float slack =
        cold.colliderCount == 1 && !cold.children ? 0.5f * SpeculativeDistance(world.settings, *cold.shape) : 0.0f;
    const bool flewAsForeseen =
        !world.coloring.IsTouched(body) && LengthSquared(Vector3(a[0], a[1], a[2])) * dt * dt * dt * dt < slack * slack;
    if (flewAsForeseen || LengthSquared(moved) <= slack * slack) return true;
    bool stays = true;
    VisitColliders(world, body, [&](uint32_t i) {
        if (world.colliders.colliders[i].fat.Contains(TightBoundsOf(world, i))) return;
        findings.outsideFatBounds.push_back(i);
        stays = false;
    });
    return stays;
}

// Chooses how the candidates of a body that moved far are found.
void LookAtBody(const WorldState& world, SweepStore& sweeps, uint32_t body, WorkerFindings& findings) {
    using SearchBy = SweepStore::SearchBy;
    const SweepStore::Start& start = sweeps.starts[body];
    const BodyDynamics& d = world.bodies.dynamics[body];
    if (start.step != world.step || d.frozen) return;
    const Vector3 moved = (world.bodies.CenterOf(body) - start.pose.position).cast<float>();
    const bool stays = StaysInBounds(world, body, moved, sweeps.dt, findings);
    if (!d.continuous) return;
    const bool turns = IsCastTurning(world, body);
    const float distance = Length(moved) + (turns ? Length(SweepOf(world, sweeps, body).turn) * d.outerRadius : 0.0f);
    if (!(distance > FreeMotionOf(world, body))) return;
    sweeps.searchBy[body] = stays && !turns ? SearchBy::Pairs : SearchBy::Trees;
}

// What the solver moved out of its fat bounds is given bounds about its whole path, so that the trees find it there.
void EnlargeBounds(WorldState& world, std::span<WorkerFindings> workers) {
    std::vector<uint32_t>& moved = world.colliders.moved;
    const size_t first = moved.size();
    for (WorkerFindings& findings : workers) {
        for (uint32_t collider : findings.outsideFatBounds) {
            world.colliders.Queue(collider);
            Collider& c = world.colliders.colliders[collider];
            c.fat.Include(TightBoundsOf(world, collider));
            world.colliders.TreeOf(c).Update(collider, c.fat);
        }
        findings.outsideFatBounds.clear();
    }
    std::sort(moved.begin() + static_cast<ptrdiff_t>(first), moved.end());
}

// Returns how many there are.
uint32_t FindFast(WorldState& world, SweepStore& sweeps, std::span<WorkerFindings> workers) {
    using SearchBy = SweepStore::SearchBy;
    sweeps.searchBy.assign(world.bodies.Size(), SearchBy::None);
    const std::vector<uint32_t>& awake = world.bodies.awake;
    world.jobs->ParallelFor(static_cast<uint32_t>(awake.size()), 64, [&](JobRange range) {
        for (uint32_t k = range.begin; k < range.end; ++k) LookAtBody(world, sweeps, awake[k], workers[range.worker]);
    });
    EnlargeBounds(world, workers);
    const size_t slow = static_cast<size_t>(std::count(sweeps.searchBy.begin(), sweeps.searchBy.end(), SearchBy::None));
    const size_t fast = sweeps.searchBy.size() - slow;
    // To look through all pairs for a few bodies would take longer than their searches.
    constexpr size_t kPairsPerSearch = 16;
    if (fast * kPairsPerSearch < world.pairs.active.Size())
        std::replace(sweeps.searchBy.begin(), sweeps.searchBy.end(), SearchBy::Pairs, SearchBy::Trees);
    return static_cast<uint32_t>(fast);
}

// Of the collider of a pair that is to be cast against the other; kNone: neither.
uint32_t CasterOf(const SweepStore& sweeps, const Pair& pair) {
    using SearchBy = SweepStore::SearchBy;
    const SearchBy a = sweeps.searchBy[pair.bodyA], b = sweeps.searchBy[pair.bodyB];
    if (a == SearchBy::Trees || b == SearchBy::Trees) return SweepStore::kNone;  // finds the other by itself
    return a == SearchBy::Pairs ? pair.colliderA : b == SearchBy::Pairs ? pair.colliderB : SweepStore::kNone;
}

void CastPairs(const WorldState& world, const SweepStore& sweeps, std::span<WorkerFindings> workers) {
    const IndexSet& active = world.pairs.active;
    world.jobs->ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        WorkerFindings& findings = workers[range.worker];
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                const Pair& pair = world.pairs.pairs[index];
                const uint32_t caster = pair.isMore ? SweepStore::kNone : CasterOf(sweeps, pair);
                SweepHit hit;
                if (caster == SweepStore::kNone ||
                    !CastPair(world, sweeps, caster, pair.colliderA ^ pair.colliderB ^ caster, findings, hit))
                    return;
                findings.sweepHits.push_back(hit);
            });
    });
}

void CastActive(const WorldState& world, const SweepStore& sweeps, std::span<WorkerFindings> workers) {
    world.jobs->ParallelFor(static_cast<uint32_t>(sweeps.active.size()), 8, [&](JobRange range) {
        WorkerFindings& findings = workers[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            SweepHit hit;
            if (CastSweep(world, sweeps, sweeps.swept[sweeps.active[i]], findings, hit))
                findings.sweepHits.push_back(hit);
        }
    });
}

void GatherHits(std::span<WorkerFindings> workers, std::vector<SweepHit>& hits) {
    hits.clear();
    for (WorkerFindings& findings : workers) {
        hits.insert(hits.end(), findings.sweepHits.begin(), findings.sweepHits.end());
        findings.sweepHits.clear();
    }
}

// The lists get room by the number of those that may need it.
void ReserveLists(const WorldState& world, SweepStore& sweeps, std::span<WorkerFindings> workers) {
    const size_t users = world.bodies.continuousCount;
    sweeps.searchBy.reserve(world.bodies.Size());
    sweeps.places.resize(world.bodies.Size(), SweepStore::kNone);
    sweeps.swept.reserve(users);
    sweeps.hits.reserve(2 * users);
    for (std::vector<uint32_t>* list : {&sweeps.active, &sweeps.next}) list->reserve(2 * users);
    for (WorkerFindings& findings : workers) {
        findings.sweepHits.reserve(users);
        findings.outsideFatBounds.reserve(world.colliders.colliders.capacity());
    }
}

void StartSweeps(const WorldState& world, SweepStore& sweeps) {
    sweeps.active.clear();
    for (uint32_t body = 0; body < sweeps.searchBy.size(); ++body)
        if (sweeps.searchBy[body] == SweepStore::SearchBy::Trees) sweeps.active.push_back(PlaceOf(world, sweeps, body));
}

// What a hit moved out of its fat bounds is found there by the casts of the others.
void EnlargeBounds(WorldState& world, const Sweep& sweep) {
    const Pose end = sweep.PoseAt(1);
    if (!world.bodies.CanMove(sweep.body) || !IsFinite(end.position) || !IsFinite(end.rotation)) return;
    world.bodies.SetCenterPose(sweep.body, end);
    VisitColliders(world, sweep.body, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        const Bounds tight = TightBoundsOf(world, i);
        if (collider.fat.Contains(tight)) return;
        world.colliders.Queue(i);
        collider.fat.Include(tight);
        world.colliders.TreeOf(collider).Update(i, collider.fat);
    });
}

// Those that hits have changed, or left undecided, are searched in the next round.
void EndRound(WorldState& world, SweepStore& sweeps) {
    for (uint32_t place : sweeps.next) {
        sweeps.swept[place].changed = false;
        EnlargeBounds(world, sweeps.swept[place]);
    }
    std::sort(sweeps.next.begin(), sweeps.next.end());
    sweeps.active.swap(sweeps.next);
    sweeps.next.clear();
}

}  // namespace

void Continuous(WorldState& world, SweepStore& sweeps, std::span<WorkerFindings> workers, ScratchArena& scratch,
                StepReport& report) {
    sweeps.swept.clear();
    sweeps.ended.clear();
    sweeps.endedAt.clear();
    if (world.bodies.continuousCount == 0) return;
    ReserveLists(world, sweeps, workers);
    const uint32_t fast = FindFast(world, sweeps, workers);
    report.sweptBodies = fast;
    if (fast == 0) return;
    StartSweeps(world, sweeps);
    const bool usesPairs = sweeps.active.size() < fast;
    for (int round = 0; round < kRounds && (!sweeps.active.empty() || (round == 0 && usesPairs)); ++round) {
        if (round == 0 && usesPairs) CastPairs(world, sweeps, workers);
        CastActive(world, sweeps, workers);
        GatherHits(workers, sweeps.hits);
        ResolveHits(world, sweeps, round + 1 == kRounds, scratch, report);
        EndRound(world, sweeps);
    }
    for (const Sweep& sweep : sweeps.swept) sweeps.places[sweep.body] = SweepStore::kNone;
}

}  // namespace fulcrum
