#include <Fulcrum/Physics/Stages/CrowdContacts.h>

#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>
#include <Fulcrum/Physics/Stages/CrowdPlaces.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// Parts of the sum of two shapes' inner radii.
constexpr float kCenterOffset =
    1e-3f;  // of coincident centers: a distance that gives a direction, and too short to be seen
constexpr float kCrowdedOverlap = 0.01f;  // by less than this, as bodies at rest on each other do, nothing is crowded
// The part of an overlap with an immovable body that is removed within a substep: all at once would throw bodies up.
constexpr float kImmovableOverlapRemoved = 0.125f;

// m, as the step began: the least of a manifold's points, below zero where they overlap.
float SeparationOf(const WorldState& world, uint32_t index, const Vector3& normal) {
    const Pair& pair = world.pairs.pairs[index];
    const Pose a = world.bodies.CenterPoseOf(pair.bodyA), b = world.bodies.CenterPoseOf(pair.bodyB);
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < pair.pointCount; ++i) {
        const ContactRecord::Point& p = world.pairs.records[index].points[i];
        const Position onA = a.Transform(Vector3(p.onA[0], p.onA[1], p.onA[2])),
                       onB = b.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2]));
        least = std::min(least, Dot<float>(normal, Vector3((onB - onA).cast<float>())));
    }
    return least;
}

// Moves what the workers noted into one list, sorted: the same for any number of threads.
void Gather(std::span<WorkerFindings> workers, std::vector<uint32_t> WorkerFindings::*list,
            std::vector<uint32_t>& all) {
    all.clear();
    for (WorkerFindings& findings : workers) {
        all.insert(all.end(), (findings.*list).begin(), (findings.*list).end());
        (findings.*list).clear();
    }
    std::sort(all.begin(), all.end());
}

// How often the most frequent of numbers occurs; they are sorted.
size_t MostRepeated(std::span<const uint32_t> numbers) {
    size_t most = 0;
    for (size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        while (end < numbers.size() && numbers[end] == numbers[begin]) ++end;
        most = std::max(most, end - begin);
    }
    return most;
}

}  // namespace

Vector3 ContactNormal(const WorldState& world, uint32_t pair) {
    const float(&n)[3] = world.pairs.records[pair].normal;
    return Rotate(world.bodies.RotationOf(world.pairs.pairs[pair].bodyA), Vector3(n[0], n[1], n[2]));
}

RelativePose WithDistinctCenters(const WorldState& world, const Pair& pair, const RelativePose& bInA) {
    const float offset = kCenterOffset * (pair.shapeA->InnerRadius() + pair.shapeB->InnerRadius());
    if (LengthSquared(bInA.position) > offset * offset) return bInA;
    Vector3 away = PointInBall(pair.bodyB) - PointInBall(pair.bodyA);
    away = InverseRotate(world.bodies.RotationOf(pair.bodyA), away);
    if (pair.offset) away = InverseRotate(world.colliders.shapes[pair.colliderA].local.rotation, away);
    return {bInA.position + Normalized(away, Vector3(0, 1, 0)) * offset, bInA.rotation};
}

void NoteOverlap(const WorldState& world, uint32_t index, const RelativePose& bInA, WorkerFindings& findings) {
    const Pair& pair = world.pairs.pairs[index];
    if (pair.fixedB) return;
    const float deep = DeepOverlapDistance(*pair.shapeA, *pair.shapeB);
    if (LengthSquared(bInA.position) < deep * deep)
        for (const uint32_t body : {pair.bodyA, pair.bodyB}) findings.deepOverlaps.push_back(body);
    const auto isCrowded = [&](uint32_t body) { return world.bodies.dynamics[body].crowded; };
    if (!isCrowded(pair.bodyA) && !isCrowded(pair.bodyB)) return;
    const float radii = pair.shapeA->InnerRadius() + pair.shapeB->InnerRadius();
    if (SeparationOf(world, index, ContactNormal(world, index)) > -kCrowdedOverlap * radii) return;
    for (const uint32_t body : {pair.bodyA, pair.bodyB})
        if (isCrowded(body)) findings.crowdedOverlaps.push_back(body);
}

void GatherCrowd(BodyStore& bodies, CrowdState& crowd, std::span<WorkerFindings> workers) {
    for (const uint32_t body : crowd.crowded) bodies.dynamics[body].crowded = false;
    Gather(workers, &WorkerFindings::crowdedOverlaps, crowd.crowded);
    for (const DispersingBody& dispersing : crowd.dispersing) crowd.crowded.push_back(dispersing.body);
    for (const uint32_t body : crowd.crowded) bodies.dynamics[body].crowded = true;
    Gather(workers, &WorkerFindings::deepOverlaps, crowd.deepOverlaps);
    if (MostRepeated(crowd.deepOverlaps) < kManyOverlaps) crowd.deepOverlaps.clear();
}

void LimitPush(WorldState& world, uint32_t body, float h) {
    const auto& free = world.bodies.unconstrained[body].row;
    const Vector3 freeV = VectorAt<BodyState::kLinear>(free), freeW = VectorAt<BodyState::kAngular>(free);
    Vector3 push = world.bodies.LinearVelocityOf(body) - freeV, spin = world.bodies.AngularVelocityOf(body) - freeW;
    const float fastest = world.settings.contactPushSpeed;
    LimitLength(push, fastest);
    LimitLength(spin, fastest / world.bodies.dynamics[body].outerRadius);
    Vector3 v = freeV + push;
    const float(&moved)[3] = world.bodies.states[body].deltaPosition;
    VisitImmovableContacts(world, body, [&](uint32_t pair) {
        const Vector3 normal = ContactNormal(world, pair);
        const float gap = SeparationOf(world, pair, normal) - Dot<float>(normal, Vector3(moved[0], moved[1], moved[2]));
        const float most = gap >= 0 ? gap / h : std::max(gap * kImmovableOverlapRemoved / h, -fastest);
        const float into =
            Dot<float>(normal, Vector3(v - world.bodies.LinearVelocityOf(world.pairs.pairs[pair].bodyB)));
        if (into > most) v -= normal * (into - most);
    });
    world.bodies.SetVelocity(body, v, freeW + spin);
}

}  // namespace fulcrum
