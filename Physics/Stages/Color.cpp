// Contacts that began get a color, those that ended lose it; joints do so when they come and go, wake and sleep.
// Serial, and in an order that depends on what touches what alone: the same colors for any number of threads, and
// however coarse the bounds are by which pairs were found, so that a scene far out is solved as at the origin.
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

namespace {

using Coloring = ConstraintColoring;

Coloring::Kind KindOf(const Pair& pair) { return pair.fixedB ? Coloring::Kind::Fixed : Coloring::Kind::Moving; }
Coloring::Entry EntryOf(const Joint& joint, uint32_t index) {
    return {index, joint.body[0], joint.body[1], joint.still[0], joint.still[1]};
}
Coloring::Entry EntryOf(const Pair& pair, uint32_t index) {
    return {index, pair.bodyA, pair.bodyB, false, pair.fixedB};
}

}  // namespace

void ColorPair(WorldState& world, uint32_t index) {
    Pair& pair = world.pairs.pairs[index];
    if (pair.color.color != 0xFF) return;
    // Contacts with what does not move come last: they must win.
    pair.color = world.coloring.Add(KindOf(pair), EntryOf(pair, index), pair.fixedB);
}

void UncolorPair(WorldState& world, uint32_t index) {
    Pair& pair = world.pairs.pairs[index];
    if (pair.color.color == 0xFF) return;
    const uint32_t moved = world.coloring.Remove(KindOf(pair), EntryOf(pair, index), pair.color);
    world.pairs.pairs[moved].color.slot = pair.color.slot;
    pair.color = {};
}

void RemovePair(WorldState& world, uint32_t index) {
    while (index != PairStore::kNone) {
        const uint32_t next = world.pairs.pairs[index].more;
        UncolorPair(world, index);
        world.pairs.Remove(index);
        index = next;
    }
}

bool MovesAwake(const WorldState& world, uint32_t index) {
    const Joint& joint = world.joints.joints[index];
    const auto isAwake = [&](int side) { return !joint.still[side] && world.bodies.dynamics[joint.body[side]].awake; };
    return isAwake(0) || isAwake(1);
}

void ColorJoint(WorldState& world, uint32_t index) {
    Joint& joint = world.joints.joints[index];
    if (joint.color.color != 0xFF || !joint.enabled || !MovesAwake(world, index)) return;
    world.coloring.ReserveBodies(world.bodies.Size());
    const bool late = joint.priority == JointPriority::High || joint.still[0] || joint.still[1];
    joint.color = world.coloring.Add(Coloring::Kind::Joint, EntryOf(joint, index), late);
}

void UncolorJoint(WorldState& world, uint32_t index) {
    Joint& joint = world.joints.joints[index];
    if (joint.color.color == 0xFF) return;
    const uint32_t moved = world.coloring.Remove(Coloring::Kind::Joint, EntryOf(joint, index), joint.color);
    world.joints.joints[moved].color.slot = joint.color.slot;
    joint.color = {};
}

void RecolorJointsOf(WorldState& world, uint32_t body) {
    world.joints.VisitOf(body, [&](uint32_t index) {
        Joint& joint = world.joints.joints[index];
        bool& still = joint.still[joint.SideOf(body)];
        if (still == !world.bodies.CanMove(body)) return;
        UncolorJoint(world, index);
        still = !still;
        ColorJoint(world, index);
    });
}

void Color(WorldState& world) {
    world.coloring.ReserveBodies(world.bodies.Size());
    std::vector<uint32_t>& began = world.began;
    began.clear();
    VisitChanges(world, [&](uint32_t index) {
        const PairChange change = world.changes[index];
        world.changes[index] = PairChange::None;
        switch (change) {
            case PairChange::Began: began.push_back(index); break;
            case PairChange::Ended:
                UncolorPair(world, index);
                if (world.pairs.pairs[index].isMore) world.pairs.active.Erase(index);
                break;
            case PairChange::Dead: RemovePair(world, index); break;
            case PairChange::None:
            case PairChange::WakesOther: break;
        }
    });
    // Indices of pairs tell when their bounds met.
    std::sort(began.begin(), began.end(), [&](uint32_t x, uint32_t y) {
        const Pair &a = world.pairs.pairs[x], &b = world.pairs.pairs[y];
        return std::tie(a.colliderA, a.colliderB, a.features[0], x) <
               std::tie(b.colliderA, b.colliderB, b.features[0], y);
    });
    for (uint32_t index : began) {
        ColorPair(world, index);
        world.pairs.active.Insert(index);
    }
}

}  // namespace fulcrum
