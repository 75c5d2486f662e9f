// Combined friction and restitution of two bodies.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/ColliderStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

struct PairMaterial {
    float friction, restitution;
};
// For bodies A and B; `material`: index into the palette of B's shape, if it has one.
PairMaterial MaterialOfPair(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB,
                            uint8_t material);
// Writes the combined material of a pair to its record, if it has one.
void CombineMaterials(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t pair);

}  // namespace fulcrum
