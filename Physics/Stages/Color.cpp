// Contacts that began get a colour, those that ended lose it. Serial, in the order of the pairs, which depends on the
// history alone: the same colours for any number of threads.
#include <Fulcrum/Physics/Stages/Stages.h>

namespace fulcrum {

void ColourPair(WorldState& world, uint32_t index) {
    Pair& pair = world.pairs.pairs[index];
    if (pair.colour.colour != 0xFF) return;
    pair.colour = world.colouring.Add(index, pair.bodyA, pair.bodyB, pair.fixedB);
}

void UncolourPair(WorldState& world, uint32_t index) {
    Pair& pair = world.pairs.pairs[index];
    if (pair.colour.colour == 0xFF) return;
    const uint32_t moved = world.colouring.Remove(index, pair.colour, pair.bodyA, pair.bodyB, pair.fixedB);
    world.pairs.pairs[moved].colour.slot = pair.colour.slot;
    pair.colour = {};
}

void Color(WorldState& world) {
    world.colouring.ReserveBodies(world.bodies.Size());
    VisitChanges(world, [&](uint32_t index) {
        const PairChange change = world.changes[index];
        world.changes[index] = PairChange::None;
        switch (change) {
            case PairChange::Began: ColourPair(world, index); break;
            case PairChange::Ended: UncolourPair(world, index); break;
            case PairChange::Dead:
                UncolourPair(world, index);
                world.pairs.Remove(index);
                break;
            case PairChange::None:
            case PairChange::WakesOther: break;
        }
    });
}

}  // namespace fulcrum
