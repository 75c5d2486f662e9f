// Islands are sets of dynamic bodies that touch one another or are joined. They are found only when some body has been
// slow for long enough: nothing else needs them. An island sleeps when all its bodies are slow.
#include <Fulcrum/Physics/Islands/UnionFind.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Places in bodies.awake are the elements; the result is the root of each.
std::span<uint32_t> AwakeIslands(WorldState& world) {
    std::span<uint32_t> parents = world.scratch.Allocate<uint32_t>(world.bodies.awake.size());
    UnionFind sets(parents);
    world.pairs.active.Visit([&](uint32_t index) {
        const Pair& pair = world.pairs.pairs[index];
        if (!pair.touching || pair.fixedB) return;
        sets.Unite(world.bodies.cold[pair.bodyA].awakePlace, world.bodies.cold[pair.bodyB].awakePlace);
    });
    for (int c = 0; c <= ConstraintColoring::kColors; ++c)
        for (const ConstraintColoring::Entry& entry : world.coloring.At(c).Of(ConstraintColoring::Kind::Joint))
            if (!entry.stillA && !entry.stillB)
                sets.Unite(world.bodies.cold[entry.bodyA].awakePlace, world.bodies.cold[entry.bodyB].awakePlace);
    for (uint32_t i = 0; i < parents.size(); ++i) parents[i] = sets.Find(i);
    return parents;
}

// Pairs without an awake body rest until one of their bodies wakes.
void RestPairs(WorldState& world) {
    const auto awake = [&](uint32_t body) { return world.bodies.dynamics[body].awake; };
    world.pairs.active.Visit([&](uint32_t index) {
        Pair& pair = world.pairs.pairs[index];
        if (awake(pair.bodyA) || awake(pair.bodyB)) return;
        UncolorPair(world, index);
        pair.touching = false;
        world.pairs.active.Erase(index);
    });
}

}  // namespace

// What falls asleep outside its fat bounds, because it was fast or the step long, would be found by nobody until it
// wakes.
static void RefitFatBounds(WorldState& world, uint32_t body) {
    VisitColliders(world, body, [&](uint32_t i) {
        Collider& collider = world.colliders.colliders[i];
        if (collider.fat.Contains(TightBoundsOf(world, i))) return;
        SetFatBounds(world, i);
        world.colliders.TreeOf(collider).Update(i, collider.fat);
        world.outsideFatBounds.Forget(i);
        collider.previous = {};
        world.colliders.Queue(i);
    });
}

void PutToSleep(WorldState& world, std::span<const uint32_t> bodies) {
    const uint32_t island = world.sleeping.Add(bodies);
    for (uint32_t body : bodies) {
        world.bodies.cold[body].sleepingIsland = island;
        world.bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
        world.bodies.ForgetForces(body);
        world.bodies.MarkAsleep(body);
        RefitFatBounds(world, body);
    }
    for (uint32_t body : bodies)
        world.joints.VisitOf(body, [&](uint32_t joint) {
            if (!MovesAwake(world, joint)) UncolorJoint(world, joint);
        });
}

void SleepIslandOf(WorldState& world, uint32_t body) {
    const std::span<uint32_t> roots = AwakeIslands(world);
    const uint32_t root = roots[world.bodies.cold[body].awakePlace];
    std::vector<uint32_t> members;
    for (size_t i = 0; i < roots.size(); ++i)
        if (roots[i] == root) members.push_back(world.bodies.awake[i]);
    PutToSleep(world, members);
    RestPairs(world);
}

void Sleep(WorldState& world) {
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
    uint32_t candidates = 0;
    for (const WorkerFindings& findings : world.findings) candidates += findings.sleepCandidates;
    if (candidates > 0 && world.settings.sleep.enabled) {
        const std::span<uint32_t> roots = AwakeIslands(world);
        const size_t count = roots.size();
        // An island may sleep unless one of its bodies objects.
        std::span<uint8_t> awake = world.scratch.Allocate<uint8_t>(count);
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
                if (pair.touching && world.pairs.records[index].surfaceMoves > 0)
                    awake[roots[world.bodies.cold[pair.bodyA].awakePlace]] = 1;
            });
        // Members of sleeping islands, sorted by island.
        std::span<uint64_t> members = world.scratch.Allocate<uint64_t>(count);
        size_t sleepers = 0;
        for (size_t i = 0; i < count; ++i)
            if (!awake[roots[i]]) members[sleepers++] = uint64_t(roots[i]) << 32 | world.bodies.awake[i];
        std::sort(members.begin(), members.begin() + static_cast<ptrdiff_t>(sleepers));
        std::span<uint32_t> island = world.scratch.Allocate<uint32_t>(count);
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
