#include <Fulcrum/Physics/Stages/Crowd.h>

#include <limits>

namespace fulcrum {

namespace {

// The hair, as a part of the sum of the inner radii.
constexpr float kHair = 1e-3f;

// A finalizer of MurmurHash3's kind: every bit of the input turns about half of the output.
uint64_t Mix(uint64_t x) {
    x ^= x >> 33;
    x *= 0xFF51AFD7ED558CCDull;
    x ^= x >> 33;
    x *= 0xC4CEB9FE1A85EC53ull;
    return x ^ x >> 33;
}

float InnerRadii(const Shape& a, const Shape& b) { return a.InnerRadius() + b.InnerRadius(); }

Position CenterOf(const WorldState& world, uint32_t collider) {
    const uint32_t body = world.colliders.colliders[collider].body;
    const Position center = world.bodies.CentreOf(body);
    if (!world.colliders.shapes[collider].offset) return center;
    return center + Rotate(world.bodies.RotationOf(body), LocalOf(world, collider).position).cast<double>();
}

}  // namespace

Vector3 PlaceInCrowd(uint32_t body) {
    for (uint64_t seed = body;; seed += uint64_t(1) << 32) {
        const uint64_t bits = Mix(seed + 1);
        Vector3 place;
        for (int k = 0; k < 3; ++k)
            place[k] = static_cast<float>(static_cast<int32_t>(bits >> (21 * k) & 0x1FFFFF) - 0x100000) * 0x1p-20f;
        if (LengthSquared(place) <= 1) return place;
    }
}

RelativePose WithDistinctCenters(const WorldState& world, const Pair& pair, const RelativePose& bInA) {
    const float hair = kHair * InnerRadii(*pair.shapeA, *pair.shapeB);
    if (LengthSquared(bInA.position) > hair * hair) return bInA;
    Vector3 away = PlaceInCrowd(pair.bodyB) - PlaceInCrowd(pair.bodyA);
    away = InverseRotate(world.bodies.RotationOf(pair.bodyA), away);
    if (pair.offset) away = InverseRotate(world.colliders.shapes[pair.colliderA].local.rotation, away);
    return {bInA.position + Normalized(away, Vector3(0, 1, 0)) * hair, bInA.rotation};
}

float Nearness(const WorldState& world, uint32_t colliderA, uint32_t colliderB) {
    const uint32_t a = world.colliders.colliders[colliderA].body, b = world.colliders.colliders[colliderB].body;
    constexpr float kFar = std::numeric_limits<float>::infinity();
    if (world.bodies.dynamics[a].motion != MotionType::Dynamic || world.bodies.dynamics[b].motion != MotionType::Dynamic) return kFar;
    const Vector3 between = (CenterOf(world, colliderB) - CenterOf(world, colliderA)).cast<float>();
    const float radii = InnerRadii(*world.colliders.shapes[colliderA].shape, *world.colliders.shapes[colliderB].shape);
    if (!(radii > 0) || LengthSquared(between) > radii * radii) return kFar;
    return Length(Vector3(between * (1 / radii) + (PlaceInCrowd(b) - PlaceInCrowd(a)) * kHair));
}

}  // namespace fulcrum
