#include <Fulcrum/Physics/Stages/Crowd.h>

#include <Fulcrum/Physics/Stages/BodyLimits.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

// The hair, as a part of the sum of the inner radii.
constexpr float kHair = 1e-3f;

// So many others are many. What is packed as densely as balls can be has twelve neighbors, and stands in none of them.
constexpr size_t kMany = 6;
// And overlapping by more than this part of the sum of the inner radii they are in it still.
constexpr float kOverlap = 0.01f;
// What a body in the middle of the ball may be pushed by, as a part of one at its surface.
constexpr float kSlowest = 0.2f;
// The part of an overlap with what does not move that goes within a substep.
constexpr float kPushedOut = 0.125f;

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

// World space, from A to B.
Vector3 NormalOf(const WorldState& world, uint32_t pair) {
    const float(&n)[3] = world.pairs.records[pair].normal;
    return Rotate(world.bodies.RotationOf(world.pairs.pairs[pair].bodyA), Vector3(n[0], n[1], n[2]));
}

// m, as the step began: the least of a manifold's points.
float SeparationOf(const WorldState& world, uint32_t index, const Vector3& normal) {
    const Pair& pair = world.pairs.pairs[index];
    const Pose a = world.bodies.CentrePoseOf(pair.bodyA), b = world.bodies.CentrePoseOf(pair.bodyB);
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < pair.pointCount; ++i) {
        const ContactRecord::Point& p = world.pairs.records[index].points[i];
        const Position onA = a.Transform(Vector3(p.onA[0], p.onA[1], p.onA[2])), onB = b.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2]));
        least = std::min(least, Dot<float>(normal, Vector3((onB - onA).cast<float>())));
    }
    return least;
}

// Calls visit(pair) for the manifolds of a body with what does not move.
template <class Visit>
void VisitFixedContacts(const WorldState& world, uint32_t body, const Visit& visit) {
    VisitColliders(world, body, [&](uint32_t collider) {
        world.pairs.VisitOf(collider, [&](uint32_t first) {
            for (uint32_t pair = first; pair != PairStore::kNone; pair = world.pairs.pairs[pair].more)
                if (world.pairs.pairs[pair].fixedB && world.pairs.pairs[pair].touching) visit(pair);
        });
    });
}

bool StandsInMany(const WorldState& world, uint32_t body) {
    const auto [first, last] = std::equal_range(world.standing.begin(), world.standing.end(), body);
    return static_cast<size_t>(last - first) >= kMany;
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

void NoteStanding(const WorldState& world, uint32_t index, const RelativePose& bInA, WorkerFindings& findings) {
    const Pair& pair = world.pairs.pairs[index];
    if (pair.fixedB) return;
    const float radii = InnerRadii(*pair.shapeA, *pair.shapeB);
    if (LengthSquared(bInA.position) < kDeepNearness * kDeepNearness * radii * radii)
        for (const uint32_t body : {pair.bodyA, pair.bodyB}) findings.standing.push_back(body);
    const auto isCrowded = [&](uint32_t body) { return world.bodies.dynamics[body].crowded; };
    if (!isCrowded(pair.bodyA) && !isCrowded(pair.bodyB)) return;
    if (SeparationOf(world, index, NormalOf(world, index)) > -kOverlap * radii) return;
    for (const uint32_t body : {pair.bodyA, pair.bodyB})
        if (isCrowded(body)) findings.overlapping.push_back(body);
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

void LimitPush(WorldState& world, uint32_t body, float h) {
    const float* free = world.bodies.unconstrained[body].row;
    const Vector3 freeV(free[0], free[1], free[2]), freeW(free[3], free[4], free[5]);
    Vector3 push = world.bodies.LinearVelocityOf(body) - freeV, spin = world.bodies.AngularVelocityOf(body) - freeW;
    const float fastest = world.settings.contactPushSpeed;
    const float mine = StandsInMany(world, body) ? fastest * std::max(Length(PlaceInCrowd(body)), kSlowest) : fastest;
    LimitLength(push, mine);
    LimitLength(spin, mine / world.bodies.dynamics[body].outerRadius);
    Vector3 v = freeV + push;
    const float(&moved)[3] = world.bodies.states[body].deltaPosition;
    VisitFixedContacts(world, body, [&](uint32_t pair) {
        const Vector3 normal = NormalOf(world, pair);
        const float gap = SeparationOf(world, pair, normal) - Dot<float>(normal, Vector3(moved[0], moved[1], moved[2]));
        const float most = gap >= 0 ? gap / h : std::max(gap * kPushedOut / h, -fastest);
        const float into = Dot<float>(normal, Vector3(v - world.bodies.LinearVelocityOf(world.pairs.pairs[pair].bodyB)));
        if (into > most) v -= normal * (into - most);
    });
    world.bodies.SetVelocity(body, v, freeW + spin);
}

}  // namespace fulcrum
