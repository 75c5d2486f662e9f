#include <Fulcrum/Physics/Stages/Crowd.h>

#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>
#include <Fulcrum/Physics/Stages/CrowdPlaces.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <map>

namespace fulcrum {

namespace {

// At least this many bodies that start in one step get positions in a ball. Fewer move in random directions: bodies
// that are created one by one at the same point start a few at a time, and positions in small balls would all be near
// that point.
constexpr size_t kFewestWithPlaces = 32;
// s: time for which bodies at their positions wait for free space before they move on.
constexpr float kPatience = 0.5f;
// Bodies that started together are dispersed when at most one in this many overlaps another. Contacts separate the
// rest.
constexpr uint32_t kNearlyAll = 32;

// Whether a body can disperse.
bool MovesFreely(const BodyStore& bodies, uint32_t body) {
    const BodyDynamics& d = bodies.dynamics[body];
    const BodyCold& cold = bodies.cold[body];
    return cold.exists && !cold.removed && !cold.isSensor && d.awake && !d.frozen && d.motion == MotionType::Dynamic;
}

// Filters `bodies` by isSo(body) on all workers, preserving order.
template <class Test>
Array<uint32_t> SelectBodies(const StepWorkers& workers, std::span<const uint32_t> bodies, const Test& isSo) {
    const std::span<uint8_t> is = workers.scratch.Allocate<uint8_t>(bodies.size());
    workers.jobs.ParallelFor(static_cast<uint32_t>(bodies.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) is[i] = isSo(bodies[i]);
    });
    Array<uint32_t> selected;
    for (size_t i = 0; i < bodies.size(); ++i)
        if (is[i]) selected.push_back(bodies[i]);
    return selected;
}

// Marks the `candidates` that are to disperse, and returns them in ascending order. view: refers to `bodies`.
Array<uint32_t> MarkDispersing(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups,
                               std::span<const uint32_t> candidates, BodyStore& bodies, const StepWorkers& workers) {
    const auto mayStart = [&](uint32_t body) { return MovesFreely(bodies, body) && !bodies.dynamics[body].dispersing; };
    Array<uint32_t> starting = SelectBodies(workers, candidates, [&](uint32_t body) {
        return mayStart(body) && OverlapsManyDeeply(view, pairs, groups, body);
    });
    for (const uint32_t body : starting) bodies.dynamics[body].dispersing = true;
    // Also includes bodies that deeply overlap only a few of these, since they would be in the way.
    for (Array<uint32_t> joining = starting; !joining.empty();) {
        joining = SelectBodies(workers, candidates, [&](uint32_t body) {
            return mayStart(body) && OverlapsDispersingDeeply(view, pairs, groups, body);
        });
        for (const uint32_t body : joining) bodies.dynamics[body].dispersing = true;
        starting.insert(starting.end(), joining.begin(), joining.end());
    }
    std::sort(starting.begin(), starting.end());
    return starting;
}

void RemoveDynamicPairs(const CollisionView& view, std::span<const uint32_t> bodies, PairStore& pairs,
                        ConstraintColoring& coloring, std::span<PairChange> changes) {
    VisitPairsOf(view.bodies, view.colliders, pairs, bodies, [&](uint32_t pair) {
        if (pairs.pairs[pair].fixedB) return;
        if (pair < changes.size()) changes[pair] = PairChange::None;
        RemovePair(pairs, coloring, pair);
    });
}

// Computes where each body moves. Jointed bodies move in one direction with those connected to them.
Array<DispersingBody> PlanDispersing(const CollisionView& view, const JointedGroups& groups,
                                     std::span<const uint32_t> bodies) {
    Array<DispersingBody> planned;
    Array<uint32_t> single;
    for (const uint32_t body : bodies) {
        if (view.joints.HasAny(body)) planned.push_back({body, PointInBall(groups.RootOf(body))});
        else single.push_back(body);
    }
    if (single.size() >= kFewestWithPlaces) AssignPlaces(view, single, planned);
    else
        for (const uint32_t body : single) planned.push_back({body, PointInBall(body)});
    return planned;
}

// Adjusts the acceleration for the rest of this step: UpdateBounds has already set it, with gravity for all but
// dispersing bodies.
void AddGravity(const SystemSettings& settings, BodyStore& bodies, uint32_t body, float factor) {
    const BodyDynamics& dynamics = bodies.dynamics[body];
    const Vector3 gravity =
        dynamics.AlongFreeTranslations(bodies.GravityOf(body, settings.gravity) * (factor * dynamics.gravityFactor));
    for (int k = 0; k < 3; ++k) bodies.poses[body].acceleration[k] += gravity[k];
}

// Drops bodies that were removed, put to sleep, frozen or made kinematic meanwhile.
void ForgetStopped(BodyStore& bodies, Array<DispersingBody>& all) {
    std::erase_if(all, [&](const DispersingBody& dispersing) {
        BodyDynamics& d = bodies.dynamics[dispersing.body];
        d.dispersing &= MovesFreely(bodies, dispersing.body);
        return !d.dispersing;
    });
}

// Reflects the direction of a body without a target position at floors, walls and kinematic bodies that it touches.
void Reflect(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
             DispersingBody& dispersing) {
    VisitImmovableContacts(bodies, colliders, pairs, dispersing.body, [&](uint32_t pair) {
        const Vector3 normal = ContactNormal(bodies, pairs, pair);
        const float into = Dot<float>(normal, dispersing.direction);
        if (into > 0) dispersing.direction -= normal * (2 * into);
    });
}

void Push(const StepContext& step, const ColliderStore& colliders, const PairStore& pairs, BodyStore& bodies,
          DispersingBody& dispersing) {
    const BodyDynamics& d = bodies.dynamics[dispersing.body];
    Vector3 turn = Vector3::Zero();
    const float fastest = DispersingSpeed(step.settings);
    dispersing.ownVelocity = bodies.LinearVelocityOf(dispersing.body);
    if (dispersing.hasPlace) {
        const Position left = dispersing.place - bodies.CenterOf(dispersing.body);
        dispersing.push = (left / double{std::max(dispersing.secondsLeft, step.dt)}).cast<float>();
        dispersing.place += (dispersing.ownVelocity * step.dt).cast<double>();
    } else {
        Reflect(bodies, colliders, pairs, dispersing);
        dispersing.push = dispersing.direction * fastest;
    }
    LimitLength(dispersing.push, std::min(fastest, d.maxLinearSpeed));
    d.Lock(dispersing.push, turn);
    bodies.SetVelocity(dispersing.body, dispersing.ownVelocity + dispersing.push,
                       bodies.AngularVelocityOf(dispersing.body));
}

// The bodies that started to disperse in one step.
struct StartedTogether {
    uint32_t count = 0, overlapping = 0;
    bool isBlocked = false;  // one of them overlaps many others
    bool HaveRoom() const { return !isBlocked && overlapping * kNearlyAll <= count; }
};
using ByStart = std::map<uint64_t, StartedTogether, std::less<>, Allocator<std::pair<const uint64_t, StartedTogether>>>;

// Groups bodies by the step in which they started; overlaps[i]: whether all[i] overlaps another body.
ByStart GroupByStart(const CollisionView& view, const PairStore& pairs, std::span<const DispersingBody> all,
                     const JointedGroups& groups, std::span<const uint8_t> overlaps) {
    ByStart byStart;
    for (size_t i = 0; i < overlaps.size(); ++i) {
        StartedTogether& together = byStart[all[i].startStep];
        ++together.count;
        together.overlapping += overlaps[i];
    }
    for (size_t i = 0; i < overlaps.size(); ++i) {
        StartedTogether& together = byStart[all[i].startStep];
        if (overlaps[i] && together.HaveRoom()) together.isBlocked = OverlapsMany(view, pairs, groups, all[i].body);
    }
    return byStart;
}

}  // namespace

void StartDispersing(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                     BodyStore& bodies, PairStore& pairs, ConstraintColoring& coloring, CrowdState& crowd,
                     std::span<PairChange> changes, const StepWorkers& workers) {
    const CollisionView view{step, bodies, colliders, joints};
    Array<uint32_t>& candidates = crowd.deepOverlaps;
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    const JointedGroups groups(bodies.Size(), joints, workers.scratch);
    const Array<uint32_t> starting = MarkDispersing(view, pairs, groups, candidates, bodies, workers);
    candidates.clear();
    if (starting.empty()) return;
    RemoveDynamicPairs(view, starting, pairs, coloring, changes);
    Array<DispersingBody>& all = crowd.dispersing;
    for (DispersingBody dispersing : PlanDispersing(view, groups, starting)) {
        BodyDynamics& d = bodies.dynamics[dispersing.body];
        d.dispersing = true;
        d.crowded = 1;
        AddGravity(step.settings, bodies, dispersing.body, -1);
        dispersing.ownVelocity = bodies.LinearVelocityOf(dispersing.body);
        dispersing.startStep = step.number;
        all.push_back(dispersing);
    }
    std::sort(all.begin(), all.end(), [](const DispersingBody& a, const DispersingBody& b) { return a.body < b.body; });
}

void PushDispersing(const StepContext& step, const ColliderStore& colliders, const PairStore& pairs, BodyStore& bodies,
                    Array<DispersingBody>& all, JobSystem& jobs) {
    if (all.empty()) return;
    ForgetStopped(bodies, all);
    jobs.ParallelFor(static_cast<uint32_t>(all.size()), 64, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            DispersingBody& dispersing = all[i];
            Push(step, colliders, pairs, bodies, dispersing);
            dispersing.secondsLeft -= step.dt;
            dispersing.hasPlace &= dispersing.secondsLeft > -kPatience;
        }
    });
}

Vector3 OwnVelocity(const BodyStore& bodies, std::span<const DispersingBody> all, uint32_t body, const Vector3& v,
                    float dt) {
    const auto dispersing = std::lower_bound(all.begin(), all.end(), body,
                                             [](const DispersingBody& d, uint32_t index) { return d.body < index; });
    const float* a = bodies.poses[body].acceleration;
    return NoFasterThan(v - dispersing->push, dispersing->ownVelocity + Vector3(a[0], a[1], a[2]) * dt);
}

// Bodies that started together end together. A body whose waiting time is over ends by itself once it overlaps no
// other.
void EndDispersing(const StepContext& step, const JointStore& joints, const PairStore& pairs, BodyStore& bodies,
                   ColliderStore& colliders, Array<DispersingBody>& all, const StepWorkers& workers) {
    if (all.empty()) return;
    const CollisionView view{step, bodies, colliders, joints};
    const JointedGroups groups(bodies.Size(), joints, workers.scratch);
    const std::span<uint8_t> overlaps = workers.scratch.Allocate<uint8_t>(all.size());
    workers.jobs.ParallelFor(static_cast<uint32_t>(overlaps.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            overlaps[i] = OverlapsAnother(view, pairs, groups, all[i].body);
    });
    const ByStart together = GroupByStart(view, pairs, all, groups, overlaps);
    for (size_t i = 0; i < overlaps.size(); ++i) {
        const DispersingBody& dispersing = all[i];
        const bool hasDispersed =
            together.at(dispersing.startStep).HaveRoom() || (!dispersing.hasPlace && !overlaps[i]);
        bodies.dynamics[dispersing.body].dispersing = !hasDispersed;
    }
    std::erase_if(all, [&](const DispersingBody& dispersing) {
        if (bodies.dynamics[dispersing.body].dispersing) return false;
        AddGravity(step.settings, bodies, dispersing.body, 1);
        bodies.SetVelocity(dispersing.body, dispersing.ownVelocity, bodies.AngularVelocityOf(dispersing.body));
        RequeueColliders(bodies, colliders, dispersing.body);
        return true;
    });
}

}  // namespace fulcrum
