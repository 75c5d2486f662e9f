#include <Fulcrum/Physics/Stages/ResolveHits.h>

#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/Impact.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace fulcrum {

namespace {

class HitResolver {
public:
    HitResolver(const StepContext& step, const SleepStores& stores, SweepStore& sweeps, bool isLast, StepReport& report)
        : step_(step), stores_(stores), bodies_(stores.bodies), sweeps_(sweeps), report_(report), isLast_(isLast) {}

    // Resolves the hits in order of time. Their impacts are computed beforehand, in parallel: no body is hit twice in a
    // round. A hit whose bodies may be reached before it by a body that an earlier hit deflected waits for the next
    // round.
    void ResolveAll(const StepWorkers& workers) {
        const Array<SweepHit>& hits = sweeps_.hits;
        struct Key {
            float time;
            uint32_t body, otherCollider, index;
            auto Order() const { return std::tie(time, body, otherCollider); }
        };
        const std::span<Key> order = workers.scratch.Allocate<Key>(hits.size());
        const std::span<Impact> impacts = workers.scratch.Allocate<Impact>(hits.size());
        const ImpactStores read{step_, bodies_, stores_.coloring, sweeps_};
        workers.jobs.ParallelFor(static_cast<uint32_t>(hits.size()), 8, [&](JobRange range) {
            for (uint32_t i = range.begin; i < range.end; ++i) impacts[i] = FindImpact(read, hits[i]);
        });
        for (uint32_t i = 0; i < hits.size(); ++i) order[i] = {hits[i].time, hits[i].body, hits[i].otherCollider, i};
        std::sort(order.begin(), order.end(), [](const Key& a, const Key& b) { return a.Order() < b.Order(); });
        const std::span<uint8_t> mayChange = workers.scratch.Allocate<uint8_t>(hits.size());
        if (isLast_) {
            std::fill(mayChange.begin(), mayChange.end(), uint8_t{0});
        } else {
            const std::span<Reach> reaches = workers.scratch.Allocate<Reach>(hits.size());
            for (uint32_t i = 0; i < hits.size(); ++i)
                reaches[i] = ReachOf(hits[order[i].index], impacts[order[i].index]);
            FindReachable(reaches, mayChange, workers);
        }
        kept_.clear();
        for (uint32_t i = 0; i < hits.size(); ++i)
            Resolve(hits[order[i].index], impacts[order[i].index], mayChange[i] != 0);
        sweeps_.hits.swap(kept_);
    }

private:
    // Position and speeds of a hit's bodies, before and after it.
    struct Reach {
        Position center = Position::Zero();
        float radius = 0;             // m: a sphere that contains both
        float before = 0, after = 0;  // m per step, the faster of the two
        float time = 1;

        double Farthest() const { return double{radius} + double{std::max(before, after)}; }  // m, within the step
    };

    Reach ReachOf(const SweepHit& hit, const Impact& impact) const {
        // Undecided hits have no points and no center.
        Reach reach{.center = hit.pointCount > 0 ? hit.center : impact.poses[0].position, .time = hit.time};
        const uint32_t bodies[2] = {hit.body, hit.other};
        for (int s = 0; s < 2; ++s) {
            if (!bodies_.CanMove(bodies[s])) continue;
            const float away = Length(Between(reach.center, impact.poses[s].position));
            reach.radius = std::max(reach.radius, away + bodies_.dynamics[bodies[s]].outerRadius);
            reach.before = std::max(reach.before, Length(impact.sweeps[s].DisplacementRate()));
            if (hit.time < 1)
                reach.after = std::max(reach.after, Length(impact.rests[s].displacement) / (1 - hit.time));
        }
        return reach;
    }

    // For hits in order of time: which may be changed by bodies deflected by an earlier hit. Sweep and prune along one
    // axis.
    static void FindReachable(std::span<const Reach> reaches, std::span<uint8_t> mayChange,
                              const StepWorkers& workers) {
        const std::span<uint32_t> along = workers.scratch.Allocate<uint32_t>(reaches.size());
        double farthest = 0;
        for (uint32_t i = 0; i < reaches.size(); ++i) {
            along[i] = i;
            farthest = std::max(farthest, reaches[i].Farthest());
        }
        const auto place = [&](uint32_t i) { return reaches[i].center.x(); };
        std::sort(along.begin(), along.end(),
                  [&](uint32_t a, uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
        workers.jobs.ParallelFor(static_cast<uint32_t>(reaches.size()), 16, [&](JobRange range) {
            for (uint32_t i = range.begin; i < range.end; ++i) {
                const double reach = reaches[i].Farthest() + farthest;
                mayChange[i] = 0;
                for (auto k = std::lower_bound(along.begin(), along.end(), place(i) - reach,
                                               [&](uint32_t a, double least) { return place(a) < least; });
                     k != along.end() && place(*k) <= place(i) + reach && !mayChange[i]; ++k)
                    mayChange[i] = *k < i && MayMeet(reaches[*k], reaches[i]);
            }
        });
    }

    // Whether a body of the earlier hit may reach one of the later hit before its time.
    static bool MayMeet(const Reach& earlier, const Reach& later) {
        const float most = earlier.radius + later.radius + (earlier.after + later.before) * (later.time - earlier.time);
        return LengthSquared(Between(earlier.center, later.center)) < most * most;
    }

    void Resolve(const SweepHit& hit, const Impact& impact, bool mayChange) {
        const uint32_t places[2] = {PlaceOf(step_, bodies_, sweeps_, hit.body, &impact.sweeps[0]),
                                    PlaceOf(step_, bodies_, sweeps_, hit.other, &impact.sweeps[1])};
        if (Swept(places[0]).changed) return;  // it is cast in the next round, or waits
        const bool lostPartner = places[1] != SweepStore::kNone && Swept(places[1]).changed;
        if (mayChange && !lostPartner) return kept_.push_back(hit);
        const bool isUndecided = hit.pointCount == 0 || lostPartner;
        bool isLast = isLast_;
        for (const uint32_t place : places)
            if (!lostPartner && place != SweepStore::kNone && bodies_.CanMove(Swept(place).body)) {
                Swept(place).CountHit(hit.time);
                isLast |= Swept(place).IsCrowdedWithHits();
            }
        if (hit.pointCount == 0 && !lostPartner) isLast |= ++Swept(places[0]).undecided >= Sweep::kMostUndecided;
        if (hit.isBlocked || !impact.isFinite || (isLast && isUndecided)) {
            // With its arriving velocity: an impulse applied to only one of the two would create energy. One that waits
            // already is not cast again: the same hit would be found in every round.
            if (!Swept(places[0]).waits)
                Wait(places[0], hit.time, impact, 0, impact.arrivingLinear[0], impact.arrivingAngular[0]);
        } else if (lostPartner) {
            CastAgain(places[0]);
        } else if (isUndecided) {
            Resume(places[0], hit.time, impact.poses[0]);
        } else if (!impact.bounces && (impact.sweeps[0].waits || impact.sweeps[1].waits)) {
            // A body that hits one that waits waits, too.
            for (int s = 0; s < 2; ++s)
                if (places[s] != SweepStore::kNone && !impact.sweeps[s].waits)
                    Wait(places[s], hit.time, impact, s, impact.linear[s], impact.angular[s]);
        } else {
            Bounce(hit, impact, places, isLast);
        }
    }

    // Both continue with the velocities after the hit. If no point approaches, the displacement by the solver differs
    // from the velocities. isLast: they stay where they are until the next step.
    void Bounce(const SweepHit& hit, const Impact& impact, const uint32_t (&places)[2], bool isLast) {
        WakeBody(stores_, hit.other);
        report_.sweptHits += impact.bounces;
        if (sweeps_.reportsHits && impact.bounces) Report(hit, impact);
        for (int s = 0; s < 2; ++s) {
            if (places[s] == SweepStore::kNone) continue;
            const uint32_t body = Swept(places[s]).body;
            if (!bodies_.CanMove(body)) {
                if (s == 0 || impact.bounces) Resume(places[s], hit.time, impact.poses[s]);
                continue;
            }
            bodies_.masses[body] = impact.masses[s];
            bodies_.dynamics[body].slowSeconds = 0;
            if (isLast) Wait(places[s], hit.time, impact, s, impact.linear[s], impact.angular[s]);
            else Continue(places[s], hit.time, impact, s);
        }
    }

    void Report(const SweepHit& hit, const Impact& impact) {
        ContactEvent::Manifold manifold{.normal = hit.normal,
                                        .frictionImpulse = impact.frictionImpulse,
                                        .triangle = hit.triangle,
                                        .material = hit.material,
                                        .pointCount = static_cast<uint32_t>(hit.pointCount)};
        for (int i = 0; i < hit.pointCount; ++i) {
            const Position on = hit.center + hit.arms[i].cast<double>(),
                           onOther = impact.poses[1].position + hit.otherArms[i].cast<double>();
            manifold.points[static_cast<size_t>(i)] = {
                on + (onOther - on) * 0.5, Dot<float>(hit.normal, Between(on, onOther)), impact.normalImpulses[i]};
        }
        sweeps_.reported.push_back(
            {hit.body, hit.other, hit.collider, hit.otherCollider, hit.time, impact.approachSpeed, manifold});
    }

    Sweep& Swept(uint32_t place) { return sweeps_.swept[place]; }

    void CastAgain(uint32_t place) {
        Swept(place).changed = true;
        sweeps_.next.push_back(place);
    }

    void End(uint32_t place, float time, const Pose& pose) {
        Sweep& sweep = Swept(place);
        sweeps_.ended.push_back(sweep);
        sweeps_.endedAt.push_back(time);
        sweep.start = pose;
        sweep.from = time;
        sweep.isCut = true;
        CastAgain(place);
    }

    // The rest of the same sweep.
    void Resume(uint32_t place, float time, const Pose& pose) {
        Sweep& sweep = Swept(place);
        const Vector3 displacement = sweep.DisplacementRate() * (1 - time), turn = sweep.TurnRate() * (1 - time);
        End(place, time, pose);
        sweep.displacement = displacement;
        sweep.turn = turn;
    }

    // The body stays there until the next step, an obstacle that other casts have not seen; a kinematic body continues.
    void Wait(uint32_t place, float time, const Impact& impact, int side, const Vector3& linear,
              const Vector3& angular) {
        Sweep& sweep = Swept(place);
        if (!bodies_.CanMove(sweep.body)) return;
        End(place, time, impact.poses[side]);
        sweep.displacement.setZero();
        sweep.turn.setZero();
        sweep.waits = true;
        if (impact.isFinite) SetVelocity(sweep.body, linear, angular);
    }

    void Continue(uint32_t place, float time, const Impact& impact, int side) {
        Sweep& sweep = Swept(place);
        const Impact::Rest& rest = impact.rests[side];
        End(place, time, impact.poses[side]);
        sweep.displacement = rest.displacement;
        sweep.turn = rest.turn;
        sweep.waits = false;
        SetVelocity(sweep.body, rest.linear, rest.angular);
    }

    void SetVelocity(uint32_t body, Vector3 linear, Vector3 angular) {
        report_.clampedBodies += LimitSpeeds(bodies_, body, linear, angular);
        bodies_.SetVelocity(body, linear, angular);
    }

    const StepContext& step_;
    const SleepStores& stores_;
    BodyStore& bodies_;
    SweepStore& sweeps_;
    Array<SweepHit>& kept_ = sweeps_.keptHits;
    StepReport& report_;
    bool isLast_;
};

}  // namespace

uint32_t PlaceOf(const StepContext& step, const BodyStore& bodies, SweepStore& sweeps, uint32_t body,
                 const Sweep* known) {
    if (sweeps.searchBy[body] == SweepStore::SearchBy::None && !bodies.CanMove(body)) return SweepStore::kNone;
    if (sweeps.places[body] == SweepStore::kNone) {
        Sweep sweep = known ? *known : SweepOf(step, bodies, sweeps, body);
        sweep.turns = IsCastTurning(bodies, body);
        sweeps.places[body] = static_cast<uint32_t>(sweeps.swept.size());
        sweeps.swept.push_back(sweep);
    }
    return sweeps.places[body];
}

void ResolveHits(const StepContext& step, const SleepStores& stores, SweepStore& sweeps, bool isLast,
                 const StepWorkers& workers, StepReport& report) {
    HitResolver(step, stores, sweeps, isLast, report).ResolveAll(workers);
}

}  // namespace fulcrum
