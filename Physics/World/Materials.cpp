#include <Fulcrum/Physics/World/Materials.h>

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

float Combine(CombineRule rule, float a, float b) {
    switch (rule) {
        case CombineRule::GeometricMean: return std::sqrt(a * b);
        case CombineRule::Average: return 0.5f * (a + b);
        case CombineRule::Minimum: return std::min(a, b);
        case CombineRule::Multiply: return a * b;
        case CombineRule::Maximum: return std::max(a, b);
    }
    return 0;
}

}  // namespace

PairMaterial MaterialOfPair(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB, const Shape& shapeB,
                            uint8_t material) {
    const Material& a = bodies.cold[bodyA].material;
    const Material& b = bodies.cold[bodyB].material;
    float friction = b.friction, restitution = b.restitution;
    if (shapeB.IsSurface()) {
        const std::span<const SurfaceMaterial> palette = static_cast<const SurfaceShape&>(shapeB).Materials();
        if (material < palette.size()) {
            friction = palette[material].friction;
            restitution = palette[material].restitution;
        }
    }
    return {Combine(std::max(a.frictionRule, b.frictionRule), a.friction, friction),
            Combine(std::max(a.restitutionRule, b.restitutionRule), a.restitution, restitution)};
}

void CombineMaterials(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t index) {
    const Pair& pair = pairs.pairs[index];
    if (pair.contact == PairStore::kNone) return;
    const PairMaterial material =
        MaterialOfPair(bodies, pair.bodyA, pair.bodyB, *colliders.shapes[pair.colliderB].shape, pair.material);
    ContactRecord& record = pairs.RecordOf(pair);
    record.friction = material.friction;
    record.restitution = material.restitution;
}

}  // namespace fulcrum
