#include <Fulcrum/Physics/Stages/Crowd.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// The hair, as a part of the sum of the inner radii.
constexpr float kHair = 1e-3f;

// So many others are many. What is packed as densely as balls can be has twelve neighbors, and stands in none of them.
constexpr size_t kMany = 6;
// And nearer than this they still overlap.
constexpr float kOverlapNearness = 0.99f;

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

CrowdPlace CrowdPlaceOf(const WorldState& world, uint32_t collider) {
    const uint32_t body = world.colliders.colliders[collider].body;
    if (world.bodies.dynamics[body].motion != MotionType::Dynamic) return {.innerRadius = -1};
    const float radius = world.colliders.shapes[collider].shape->InnerRadius();
    return {CenterOf(world, collider) + (PlaceInCrowd(body) * (2 * kHair * radius)).cast<double>(), radius};
}

float Nearness(const CrowdPlace& a, const CrowdPlace& b) {
    const float radii = a.innerRadius + b.innerRadius;
    if (!(a.innerRadius >= 0 && b.innerRadius >= 0 && radii > 0)) return std::numeric_limits<float>::infinity();
    return Length(Vector3((b.center - a.center).cast<float>())) / radii;
}

void NoteStanding(const WorldState& world, const Pair& pair, const RelativePose& bInA, WorkerFindings& findings) {
    if (pair.fixedB) return;
    const float radii = InnerRadii(*pair.shapeA, *pair.shapeB), squared = LengthSquared(bInA.position);
    if (!(squared < kOverlapNearness * kOverlapNearness * radii * radii)) return;
    const bool isDeep = squared < kDeepNearness * kDeepNearness * radii * radii;
    for (const uint32_t body : {pair.bodyA, pair.bodyB}) {
        if (isDeep) findings.standing.push_back(body);
        if (world.bodies.dynamics[body].crowded) findings.overlapping.push_back(body);
    }
}

void NoteCrowd(WorldState& world) {
    const auto gather = [&](std::vector<uint32_t> WorkerFindings::* list, std::vector<uint32_t>& all) {
        all.clear();
        for (WorkerFindings& findings : world.findings) {
            all.insert(all.end(), (findings.*list).begin(), (findings.*list).end());
            (findings.*list).clear();
        }
        std::sort(all.begin(), all.end());
    };
    for (const uint32_t body : world.crowd) world.bodies.dynamics[body].crowded = false;
    std::vector<uint32_t>& crowd = world.crowd;
    gather(&WorkerFindings::overlapping, crowd);
    crowd.erase(std::unique(crowd.begin(), crowd.end()), crowd.end());
    std::vector<uint32_t>& standing = world.standing;
    gather(&WorkerFindings::standing, standing);
    for (size_t begin = 0, end = 0; begin < standing.size(); begin = end) {
        while (end < standing.size() && standing[end] == standing[begin]) ++end;
        if (end - begin >= kMany) crowd.push_back(standing[begin]);
    }
    for (const uint32_t body : crowd) world.bodies.dynamics[body].crowded = true;
}

}  // namespace fulcrum
