// Islands are only computed if some body has been slow for long enough. An island falls asleep when all its bodies have
// been, and nothing accelerates or drives them (Docs/Architecture.md, Sleep).
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/Stillness.h>
#include <Fulcrum/Physics/World/Sleeping.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// What the bodies of an island may show of unrest and yet sleep.
struct IslandRest {
    float constraints = 1;  // contacts and joints among its bodies
    JointType::Quiet quiet;
    bool isMoved = false;  // by what is no part of it: a kinematic body, a moving surface
    bool lies = false;     // on something that does not move
};

// By root.
void FindRests(const StepContext& step, const SleepStores& stores, const PairStore& pairs,
               std::span<const uint32_t> roots, std::span<IslandRest> rests) {
    const BodyStore& bodies = stores.bodies;
    const auto restOf = [&](uint32_t body) -> IslandRest& { return rests[roots[bodies.cold[body].awakePlace]]; };
    const auto isMovingKinematic = [&](uint32_t body) {
        return bodies.dynamics[body].awake && bodies.dynamics[body].motion == MotionType::Kinematic;
    };
    pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = pairs.pairs[index];
        if (!pair.touching || !bodies.dynamics[pair.bodyA].awake) return;
        IslandRest& rest = restOf(pair.bodyA);
        if (!pair.fixedB) rest.constraints += 1;
        rest.lies |= pair.fixedB;
        rest.isMoved |= isMovingKinematic(pair.bodyB) ||
                        (step.listener && pairs.RecordOf(pair).Has(ContactRecord::kSurfaceVelocity));
    });
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        for (const ConstraintColoring::Entry& entry : stores.coloring.At(c).Of(ConstraintColoring::Kind::Joint)) {
            const uint32_t member = entry.fixedA ? entry.bodyB : entry.bodyA;
            if (!bodies.dynamics[member].awake) continue;
            IslandRest& rest = restOf(member);
            rest.isMoved |= isMovingKinematic(entry.bodyA) || isMovingKinematic(entry.bodyB);
            if (!entry.fixedA && !entry.fixedB) rest.constraints += 1;
            const JointType& type = *stores.joints.types[entry.constraint];
            if (type.MaxRows() == 0) continue;
            rest.quiet.speed = std::min(rest.quiet.speed, type.quiet.speed);
            rest.quiet.acceleration = std::min(rest.quiet.acceleration, type.quiet.acceleration);
        }
}

// Sets awake, by root, where one of the bodies must stay awake.
void FindWhatStaysAwake(const StepContext& step, const SleepStores& stores, const PairStore& pairs,
                        std::span<const uint32_t> roots, std::span<uint8_t> awake, ScratchArena& scratch) {
    const BodyStore& bodies = stores.bodies;
    const SleepSettings& sleep = step.settings.sleep;
    const std::span<IslandRest> rests = scratch.Allocate<IslandRest>(roots.size());
    std::fill(rests.begin(), rests.end(), IslandRest{});
    std::fill(awake.begin(), awake.end(), uint8_t(0));
    FindRests(step, stores, pairs, roots, rests);
    for (size_t i = 0; i < roots.size(); ++i) {
        if (awake[roots[i]]) continue;
        const uint32_t body = bodies.awake[i];
        const BodyDynamics& d = bodies.dynamics[body];
        const IslandRest& rest = rests[roots[i]];
        const bool isSlow = (d.slowSeconds > 0 || d.frozen) && d.slowSeconds >= sleep.seconds;
        if (d.motion != MotionType::Dynamic || !isSlow || !d.allowSleep || rest.isMoved) {
            awake[roots[i]] = 1;
            continue;
        }
        // Errors of constraints that are independent of one another add up as the root of their number. Of the speed
        // no more than twice is taken for errors: bodies that drift through space together do not sleep above 2 cm/s.
        // In a pile each hinders the others, and what creeps or rolls there at the slow speed is soon where it stays.
        const float noise = std::sqrt(rest.constraints);
        const Unrest least = LeastUnrest(bodies, body, step.settings, step.dt);
        const bool isPile = rest.lies && rest.constraints > 1;
        const float drift = isPile ? SlowSpeed(sleep, d) : least.speed * std::min(noise, 2.0f);
        const Unrest most{std::min(drift, rest.quiet.speed),
                          std::min(least.acceleration * noise, rest.quiet.acceleration)};
        if (IsRestless(bodies, body, most, sleep, step.dt)) awake[roots[i]] = 1;
    }
}

}  // namespace

void Sleep(const StepContext& step, uint32_t candidates, const SleepStores& stores, PairStore& pairs,
           CollidersOutsideFatBounds& outsideFatBounds, ScratchArena& scratch) {
    BodyStore& bodies = stores.bodies;
    // Kinematic bodies without velocity are put to rest.
    bool rested = false;
    for (size_t i = bodies.awake.size(); i-- > 0;) {
        const uint32_t body = bodies.awake[i];
        if (bodies.dynamics[body].motion != MotionType::Kinematic) continue;
        if (bodies.LinearVelocityOf(body).isZero(0) && bodies.AngularVelocityOf(body).isZero(0)) {
            bodies.MarkAsleep(body);
            rested = true;
        }
    }
    if (candidates > 0 && step.settings.sleep.enabled) {
        const size_t count = bodies.awake.size();
        const std::span<uint32_t> roots = scratch.Allocate<uint32_t>(count);
        FindAwakeIslands(bodies, pairs, stores.coloring, roots);
        const std::span<uint8_t> awake = scratch.Allocate<uint8_t>(count);
        FindWhatStaysAwake(step, stores, pairs, roots, awake, scratch);
        // Members of sleeping islands, sorted by island.
        std::span<uint64_t> members = scratch.Allocate<uint64_t>(count);
        size_t sleepers = 0;
        for (size_t i = 0; i < count; ++i)
            if (!awake[roots[i]]) members[sleepers++] = uint64_t(roots[i]) << 32 | bodies.awake[i];
        std::sort(members.begin(), members.begin() + static_cast<ptrdiff_t>(sleepers));
        std::span<uint32_t> island = scratch.Allocate<uint32_t>(count);
        for (size_t begin = 0; begin < sleepers;) {
            size_t end = begin, size = 0;
            for (; end < sleepers && members[end] >> 32 == members[begin] >> 32; ++end)
                island[size++] = static_cast<uint32_t>(members[end]);
            PutToSleep(stores, outsideFatBounds, island.first(size));
            begin = end;
        }
        rested |= sleepers > 0;
    }
    if (rested) RestPairs(bodies, pairs, stores.coloring);
}

}  // namespace fulcrum
