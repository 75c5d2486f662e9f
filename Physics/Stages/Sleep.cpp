// Islands are found only when some body has been slow for long enough: nothing else needs them. An island sleeps when
// all its bodies are slow.
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Sleeping.h>

#include <algorithm>

namespace fulcrum {

void Sleep(WorldState& world, uint32_t candidates, ScratchArena& scratch) {
    // Kinematic bodies that stand still have nothing to do.
    bool rested = false;
    for (size_t i = world.bodies.awake.size(); i-- > 0;) {
        const uint32_t body = world.bodies.awake[i];
        if (world.bodies.dynamics[body].motion != MotionType::Kinematic) continue;
        if (world.bodies.LinearVelocityOf(body).isZero(0) && world.bodies.AngularVelocityOf(body).isZero(0)) {
            world.bodies.MarkAsleep(body);
            rested = true;
        }
    }
    if (candidates > 0 && world.settings.sleep.enabled) {
        const size_t count = world.bodies.awake.size();
        const std::span<uint32_t> roots = scratch.Allocate<uint32_t>(count);
        FindAwakeIslands(world, roots);
        // An island may sleep unless one of its bodies objects.
        std::span<uint8_t> awake = scratch.Allocate<uint8_t>(count);
        std::fill(awake.begin(), awake.end(), uint8_t(0));
        for (size_t i = 0; i < count; ++i) {
            const BodyDynamics& d = world.bodies.dynamics[world.bodies.awake[i]];
            if (d.motion != MotionType::Dynamic || d.slowSeconds < world.settings.sleep.seconds || !d.allowSleep)
                awake[roots[i]] = 1;
        }
        // What a belt carries, however slowly, does not rest.
        if (world.listener)
            world.pairs.active.Visit([&](uint32_t index) {
                const Pair& pair = world.pairs.pairs[index];
                if (pair.touching && world.pairs.records[index].Has(ContactRecord::kSurfaceVelocity))
                    awake[roots[world.bodies.cold[pair.bodyA].awakePlace]] = 1;
            });
        // Members of sleeping islands, sorted by island.
        std::span<uint64_t> members = scratch.Allocate<uint64_t>(count);
        size_t sleepers = 0;
        for (size_t i = 0; i < count; ++i)
            if (!awake[roots[i]]) members[sleepers++] = uint64_t(roots[i]) << 32 | world.bodies.awake[i];
        std::sort(members.begin(), members.begin() + static_cast<ptrdiff_t>(sleepers));
        std::span<uint32_t> island = scratch.Allocate<uint32_t>(count);
        for (size_t begin = 0; begin < sleepers;) {
            size_t end = begin, size = 0;
            for (; end < sleepers && members[end] >> 32 == members[begin] >> 32; ++end)
                island[size++] = static_cast<uint32_t>(members[end]);
            PutToSleep(world, island.first(size));
            begin = end;
        }
        rested |= sleepers > 0;
    }
    if (rested) RestPairs(world);
}

}  // namespace fulcrum
