// The friction and restitution of two bodies where they touch.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

struct PairMaterial {
    float friction, restitution;
};
// Of body A, and of body B where it touches with a shape of which `material` is the index into the palette, if there is
// one.
PairMaterial MaterialOfPair(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB,
                            uint8_t material);
// Writes that of a pair into its record.
void CombineMaterials(const BodyStore& bodies, PairStore& pairs, uint32_t pair);

}  // namespace fulcrum
