// Continuous collision: bodies that moved far in this step are cast along their paths. A hit is resolved at its time of
// impact, and the bodies continue with the rest of the step. Works in rounds: all casts in parallel; then the hits in
// order of time, as long as both bodies' sweeps are still those that were cast and no earlier hit may change them
// (ResolveHits.h); bodies whose sweep changed, or that lost their hit partner, are cast again.
#include <Fulcrum/Physics/Stages/ResolveHits.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// A body that has a hit in each of this many rounds stays at its last hit until the next step.
constexpr int kRounds = 64;

// m: a body with continuous collision that moves less in a step is not cast.
float FreeMotionOf(const CollisionView& view, uint32_t body) {
    float least = std::numeric_limits<float>::infinity();
    VisitColliders(view.bodies, view.colliders, body, [&](uint32_t i) {
        const Shape& shape = *view.colliders.shapes[i].shape;
        least = std::min(least, FreeMotion(shape.InnerRadius(), shape.OuterRadius()));
    });
    return least;
}

// Whether the fat bounds of a body's colliders, which are extended by the velocity at the start of the step, contain
// its whole path. Colliders for which they do not are recorded, to be enlarged.
bool StaysInBounds(const CollisionView& view, const ConstraintColoring& coloring, uint32_t body, const Vector3& moved,
                   WorkerFindings& findings) {
    const float dt = view.step.dt;
    const float* a = view.bodies.poses[body].acceleration;
    const BodyCold& cold = view.bodies.cold[body];
    // Children of a compound may be small.
    const float slack =
        cold.colliderCount == 1 && !cold.children ? 0.5f * SpeculativeDistance(view.step.settings, *cold.shape) : 0.0f;
    const bool flewAsForeseen =
        !coloring.IsTouched(body) && LengthSquared(Vector3(a[0], a[1], a[2])) * dt * dt * dt * dt < slack * slack;
    if (flewAsForeseen || LengthSquared(moved) <= slack * slack) return true;
    bool stays = true;
    VisitColliders(view.bodies, view.colliders, body, [&](uint32_t i) {
        if (view.colliders.colliders[i].fat.Contains(TightBoundsOf(view.bodies, view.colliders, i))) return;
        findings.outsideFatBounds.push_back(i);
        stays = false;
    });
    return stays;
}

// Chooses how to find the candidates of a body that moved far.
void LookAtBody(const CollisionView& view, const ConstraintColoring& coloring, SweepStore& sweeps, uint32_t body,
                WorkerFindings& findings) {
    using SearchBy = SweepStore::SearchBy;
    const SweepStore::Start& start = sweeps.starts[body];
    const BodyDynamics& d = view.bodies.dynamics[body];
    if (start.step != view.step.number || d.frozen) return;
    const Vector3 moved = (view.bodies.CenterOf(body) - start.pose.position).cast<float>();
    const bool stays = StaysInBounds(view, coloring, body, moved, findings);
    if (!d.continuous) return;
    const bool turns = IsCastTurning(view.bodies, body),
               isBall = !turns && view.bodies.cold[body].shape->Type() == ShapeType::Sphere;
    const float free = FreeMotionOf(view, body), distance = Length(moved);
    const auto turn = [&] { return Length(SweepOf(view.step, view.bodies, sweeps, body).turn) * d.outerRadius; };
    if (!(distance > free) && (isBall || !(distance + turn() > free))) return;
    sweeps.searchBy[body] = stays && !turns ? SearchBy::Pairs : SearchBy::Trees;
}

// Makes the casts find a collider by larger fat bounds. Its tree is updated at the end (EndContinuous).
void Enlarge(ColliderStore& colliders, SweepStore& sweeps, uint32_t collider, const Bounds& bounds) {
    colliders.Queue(collider);
    Collider& c = colliders.colliders[collider];
    c.fat.Include(bounds);
    if (sweeps.enlargedTree.Contains(collider)) return sweeps.enlargedTree.Update(collider, c.fat);
    sweeps.enlarged.push_back(collider);
    if (!c.sensor) sweeps.enlargedTree.Insert(collider, c.fat);
}

// Colliders that the solver moved out of their fat bounds get bounds that contain the whole path, so that tree searches
// find them.
void EnlargeBounds(const BodyStore& bodies, ColliderStore& colliders, SweepStore& sweeps,
                   std::span<WorkerFindings> workers) {
    Array<uint32_t>& moved = colliders.moved;
    const size_t first = moved.size();
    for (WorkerFindings& findings : workers) {
        for (const uint32_t collider : findings.outsideFatBounds)
            Enlarge(colliders, sweeps, collider, TightBoundsOf(bodies, colliders, collider));
        findings.outsideFatBounds.clear();
    }
    constexpr uint32_t kFew = 8;  // in any order
    if (sweeps.enlargedTree.Size() > kFew) sweeps.enlargedTree.Rebuild();
    std::sort(moved.begin() + static_cast<ptrdiff_t>(first), moved.end());
}

// Selects the bodies to cast and returns their number. view: refers to `colliders`, whose bounds are enlarged.
uint32_t FindFast(const CollisionView& view, const PairStore& pairs, const ConstraintColoring& coloring,
                  ColliderStore& colliders, SweepStore& sweeps, const StepWorkers& workers) {
    using SearchBy = SweepStore::SearchBy;
    sweeps.searchBy.assign(view.bodies.Size(), SearchBy::None);
    const Array<uint32_t>& awake = view.bodies.awake;
    workers.jobs.ParallelFor(static_cast<uint32_t>(awake.size()), 64, [&](JobRange range) {
        for (uint32_t k = range.begin; k < range.end; ++k)
            LookAtBody(view, coloring, sweeps, awake[k], workers.findings[range.worker]);
    });
    EnlargeBounds(view.bodies, colliders, sweeps, workers.findings);
    const size_t slow = static_cast<size_t>(std::count(sweeps.searchBy.begin(), sweeps.searchBy.end(), SearchBy::None));
    const size_t fast = sweeps.searchBy.size() - slow;
    // With few bodies, searching the trees is faster than going through all pairs.
    constexpr size_t kPairsPerSearch = 16;
    if (fast * kPairsPerSearch < pairs.active.Size())
        std::replace(sweeps.searchBy.begin(), sweeps.searchBy.end(), SearchBy::Pairs, SearchBy::Trees);
    return static_cast<uint32_t>(fast);
}

// The collider of a pair that is to be cast against the other; kNone: neither.
uint32_t CasterOf(const SweepStore& sweeps, const Pair& pair) {
    using SearchBy = SweepStore::SearchBy;
    const SearchBy a = sweeps.searchBy[pair.bodyA], b = sweeps.searchBy[pair.bodyB];
    if (a == SearchBy::Trees || b == SearchBy::Trees) return SweepStore::kNone;  // searches the trees itself
    return a == SearchBy::Pairs ? pair.colliderA : b == SearchBy::Pairs ? pair.colliderB : SweepStore::kNone;
}

void CastPairs(const CollisionView& view, const PairStore& pairs, const SweepStore& sweeps,
               const StepWorkers& workers) {
    const IndexSet& active = pairs.active;
    workers.jobs.ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        WorkerFindings& findings = workers.findings[range.worker];
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                const Pair& pair = pairs.pairs[index];
                const uint32_t caster = pair.isMore ? SweepStore::kNone : CasterOf(sweeps, pair);
                SweepHit hit;
                if (caster == SweepStore::kNone ||
                    !CastPair(view, sweeps, caster, pair.colliderA ^ pair.colliderB ^ caster, findings, hit))
                    return;
                findings.sweepHits.push_back(hit);
            });
    });
}

void CastActive(const CollisionView& view, const SweepStore& sweeps, const StepWorkers& workers) {
    workers.jobs.ParallelFor(static_cast<uint32_t>(sweeps.active.size()), 8, [&](JobRange range) {
        WorkerFindings& findings = workers.findings[range.worker];
        for (uint32_t i = range.begin; i < range.end; ++i) {
            SweepHit hit;
            if (CastSweep(view, sweeps, sweeps.swept[sweeps.active[i]], findings, hit))
                findings.sweepHits.push_back(hit);
        }
    });
}

// Appends the workers' hits to those that wait.
void GatherHits(std::span<WorkerFindings> workers, Array<SweepHit>& hits) {
    for (WorkerFindings& findings : workers) {
        hits.insert(hits.end(), findings.sweepHits.begin(), findings.sweepHits.end());
        findings.sweepHits.clear();
    }
}

// Reserves the lists by the number of bodies that may need them.
void ReserveLists(const BodyStore& bodies, size_t colliders, SweepStore& sweeps, std::span<WorkerFindings> workers) {
    const size_t users = bodies.continuousCount;
    sweeps.searchBy.reserve(bodies.Size());
    sweeps.enlarged.reserve(colliders);
    sweeps.enlargedTree.Reserve(colliders);
    sweeps.places.resize(bodies.Size(), SweepStore::kNone);
    sweeps.swept.reserve(users);
    for (Array<SweepHit>* list : {&sweeps.hits, &sweeps.keptHits}) list->reserve(2 * users);
    for (Array<uint32_t>* list : {&sweeps.active, &sweeps.next}) list->reserve(2 * users);
    for (WorkerFindings& findings : workers) {
        findings.sweepHits.reserve(users);
        findings.outsideFatBounds.reserve(colliders);
    }
}

void StartSweeps(const StepContext& step, const BodyStore& bodies, SweepStore& sweeps) {
    sweeps.active.clear();
    for (uint32_t body = 0; body < sweeps.searchBy.size(); ++body)
        if (sweeps.searchBy[body] == SweepStore::SearchBy::Trees)
            sweeps.active.push_back(PlaceOf(step, bodies, sweeps, body));
}

// Enlarges the bounds of bodies that a hit moves out of them, so that other casts find them. Their poses are set at the
// end: until then casts follow the sweep.
void EnlargeBounds(const BodyStore& bodies, ColliderStore& colliders, SweepStore& sweeps, Sweep& sweep) {
    Pose end = sweep.PoseAt(1);
    if (!bodies.CanMove(sweep.body) || !IsFinite(end.position) || !IsFinite(end.rotation)) return;
    sweep.moves = true;
    end.position = OnGrid(end.position);
    VisitColliders(bodies, colliders, sweep.body, [&](uint32_t i) {
        const Bounds tight = TightBoundsAt(end, bodies, colliders, i);
        if (!colliders.colliders[i].fat.Contains(tight)) Enlarge(colliders, sweeps, i, tight);
    });
}

// Bodies whose sweeps were changed by hits or are undecided are cast in the next round.
void EndRound(const BodyStore& bodies, ColliderStore& colliders, SweepStore& sweeps) {
    for (uint32_t place : sweeps.next) {
        sweeps.swept[place].changed = false;
        EnlargeBounds(bodies, colliders, sweeps, sweeps.swept[place]);
    }
    std::sort(sweeps.next.begin(), sweeps.next.end());
    sweeps.active.swap(sweeps.next);
    sweeps.next.clear();
}

}  // namespace

void Continuous(const StepContext& step, const PairStore& pairs, const SleepStores& stores, SweepStore& sweeps,
                const StepWorkers& workers, StepReport& report) {
    BodyStore& bodies = stores.bodies;
    ColliderStore& colliders = stores.colliders;
    sweeps.swept.clear();
    sweeps.ended.clear();
    sweeps.endedAt.clear();
    sweeps.enlarged.clear();
    if (sweeps.enlargedTree.Size() > 0) sweeps.enlargedTree.Clear();
    if (bodies.continuousCount == 0) return;
    ReserveLists(bodies, colliders.colliders.capacity(), sweeps, workers.findings);
    const CollisionView view{step, bodies, colliders, stores.joints};
    const uint32_t fast = FindFast(view, pairs, stores.coloring, colliders, sweeps, workers);
    report.sweptBodies = fast;
    if (fast == 0) return;
    StartSweeps(step, bodies, sweeps);
    sweeps.hits.clear();
    const bool usesPairs = sweeps.active.size() < fast;
    const auto isDone = [&] { return sweeps.active.empty() && sweeps.hits.empty(); };
    for (int round = 0; round < kRounds && ((round == 0 && usesPairs) || !isDone()); ++round) {
        if (round == 0 && usesPairs) CastPairs(view, pairs, sweeps, workers);
        CastActive(view, sweeps, workers);
        GatherHits(workers.findings, sweeps.hits);
        ResolveHits(step, stores, sweeps, round + 1 == kRounds, workers, report);
        EndRound(bodies, colliders, sweeps);
    }
    for (const Sweep& sweep : sweeps.swept) sweeps.places[sweep.body] = SweepStore::kNone;
}

void EndContinuous(BodyStore& bodies, ColliderStore& colliders, const SweepStore& sweeps) {
    for (const Sweep& sweep : sweeps.swept)
        if (sweep.moves) bodies.SetCenterPose(sweep.body, sweep.PoseAt(1));
    for (const uint32_t i : sweeps.enlarged) {
        const Collider& collider = colliders.colliders[i];
        colliders.TreeOf(collider).Update(i, collider.fat);
    }
}

}  // namespace fulcrum
