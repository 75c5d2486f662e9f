// Assigns colors to contacts that began, frees those of contacts that ended, and removes contacts without points.
// Serial, in an order that depends only on which bodies touch: the colors do not depend on the number of threads, nor
// on the rounding of bounds, so that a scene far from the origin is solved like one at the origin.
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Colors.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

void Color(uint32_t bodyCount, std::span<PairChange> changes, PairStore& pairs, ConstraintColoring& coloring,
           Array<uint32_t>& began) {
    coloring.ReserveBodies(bodyCount);
    began.reserve(pairs.contacts.capacity());  // so that steps in steady state do not allocate
    began.clear();
    VisitChanges(changes, [&](uint32_t index) {
        const PairChange change = changes[index];
        changes[index] = PairChange::None;
        switch (change) {
            case PairChange::Began: began.push_back(index); break;
            case PairChange::Ended:
                UncolorPair(pairs, coloring, index);
                if (pairs.pairs[index].pointCount == 0 && !pairs.pairs[index].surface) pairs.RemoveContact(index);
                if (pairs.pairs[index].isMore) pairs.active.Erase(index);
                break;
            case PairChange::Dead: RemovePair(pairs, coloring, index); break;
            case PairChange::None:
            case PairChange::WakesOther: break;
        }
    });
    // Not by pair index, which depends on when bounds began to overlap.
    std::sort(began.begin(), began.end(), [&](uint32_t x, uint32_t y) {
        const Pair &a = pairs.pairs[x], &b = pairs.pairs[y];
        const uint32_t featureA = pairs.contacts[a.contact].features[0],
                       featureB = pairs.contacts[b.contact].features[0];
        return std::tie(a.colliderA, a.colliderB, featureA, x) < std::tie(b.colliderA, b.colliderB, featureB, y);
    });
    for (uint32_t index : began) {
        ColorPair(pairs, coloring, index);
        pairs.active.Insert(index);
    }
}

}  // namespace fulcrum
