// Islands are only computed if some body has been slow for long enough. An island falls asleep when all its bodies have
// been.
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Sleeping.h>

#include <algorithm>

namespace fulcrum {

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
        // An island may sleep unless one of its bodies must stay awake.
        std::span<uint8_t> awake = scratch.Allocate<uint8_t>(count);
        std::fill(awake.begin(), awake.end(), uint8_t(0));
        for (size_t i = 0; i < count; ++i) {
            const BodyDynamics& d = bodies.dynamics[bodies.awake[i]];
            if (d.motion != MotionType::Dynamic || d.slowSeconds < step.settings.sleep.seconds || !d.allowSleep)
                awake[roots[i]] = 1;
        }
        // Bodies on a moving surface stay awake, however slow it is.
        if (step.listener)
            pairs.active.Visit([&](uint32_t index) {
                const Pair& pair = pairs.pairs[index];
                if (pair.touching && pairs.RecordOf(pair).Has(ContactRecord::kSurfaceVelocity))
                    awake[roots[bodies.cold[pair.bodyA].awakePlace]] = 1;
            });
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
