#include <Fulcrum/Physics/Stages/CrowdContacts.h>

#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/CrowdOverlaps.h>
#include <Fulcrum/Physics/Stages/CrowdPlaces.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// Fractions of the sum of two shapes' inner radii.
constexpr float kCenterOffset =
    1e-3f;  // offset of coincident centers: large enough to define a direction, too small to be visible
constexpr float kCrowdedOverlap = 0.01f;  // smaller overlaps, as of bodies at rest, do not count
// Crowded bodies are separated up to this: what is left is pushed out at full stiffness, and all contacts of a pile add
// up, to 1 to 10 m/s with 1 % at steps of 1/240 s.
constexpr float kSeparatedOverlap = 0.001f;
// Less than this may be what the load of a small pile presses in, and is separated for some time only.
constexpr float kLoadedOverlap = 0.004f;
constexpr float kSettlingSeconds = 0.5f;
// Levels of crowded bodies: bodies that overlap others have the highest. Bodies that touch crowded ones and were
// crowded before have one level less than their neighbor, since recovery velocities propagate.
constexpr uint8_t kOverlaps = 3;
// In the list of CrowdState and of workers: the body times 8, plus its level or this.
constexpr uint32_t kLevelBits = 3;
constexpr uint32_t kOverlapsDeeply = kOverlaps + 1;
uint32_t BodyOf(uint32_t noted) { return noted >> kLevelBits; }
uint32_t LevelOf(uint32_t noted) { return noted & ((1u << kLevelBits) - 1); }
// The fraction of an overlap with an immovable body that is removed per substep: removing all at once would throw
// bodies up.
constexpr float kImmovableOverlapRemoved = 0.125f;

struct DeepestPoint {
    float separation = std::numeric_limits<float>::infinity();  // m, at the start of the step, negative for overlap
    float approach = 0;                                         // m/s, approach speed of the two bodies' points
};
DeepestPoint DeepestPointOf(const BodyStore& bodies, const PairStore& pairs, uint32_t index, const Vector3& normal) {
    const Pair& pair = pairs.pairs[index];
    const Pose a = bodies.CenterPoseOf(pair.bodyA), b = bodies.CenterPoseOf(pair.bodyB);
    const auto velocityOf = [&](uint32_t body, const Position& center, const Position& at) {
        return Vector3(bodies.LinearVelocityOf(body) +
                       Cross<float>(bodies.AngularVelocityOf(body), Vector3((at - center).cast<float>())));
    };
    DeepestPoint deepest;
    for (int i = 0; i < pair.pointCount; ++i) {
        const ContactRecord::Point& p = pairs.RecordOf(pair).points[i];
        const Position onA = a.Transform(Vector3(p.onA[0], p.onA[1], p.onA[2])),
                       onB = b.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2]));
        const float separation = Dot<float>(normal, Vector3((onB - onA).cast<float>()));
        if (!(separation < deepest.separation)) continue;
        deepest.separation = separation;
        deepest.approach = Dot<float>(
            normal, Vector3(velocityOf(pair.bodyA, a.position, onA) - velocityOf(pair.bodyB, b.position, onB)));
    }
    return deepest;
}

// Merges the workers' lists into one, sorted, independent of the number of threads.
void Gather(std::span<WorkerFindings> workers, Array<uint32_t> WorkerFindings::*list, Array<uint32_t>& all) {
    all.clear();
    for (WorkerFindings& findings : workers) {
        all.insert(all.end(), (findings.*list).begin(), (findings.*list).end());
        (findings.*list).clear();
    }
    std::sort(all.begin(), all.end());
}

// How long a body had been settling in the last step, s. `earlier`: those of that step; the ones before it are dropped.
float SecondsSettled(std::span<const SettlingBody>& earlier, uint32_t body) {
    while (!earlier.empty() && earlier.front().body < body) earlier = earlier.subspan(1);
    return !earlier.empty() && earlier.front().body == body ? earlier.front().seconds : 0.0f;
}

// The velocity changed by `push`: the part that only reduces speed is applied in full, the rest is limited to
// `fastest`.
Vector3 LimitedPush(const Vector3& own, const Vector3& push, float fastest) {
    const float against = -Dot<float>(push, own), squared = LengthSquared(own);
    const Vector3 left = against > 0 ? Vector3(own * (1 - std::min(against / squared, 1.0f))) : own;
    Vector3 rest = own + push - left;
    LimitLength(rest, fastest);
    return left + rest;
}

// How often the most frequent of the sorted numbers occurs.
size_t MostRepeated(std::span<const uint32_t> numbers) {
    size_t most = 0;
    for (size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        while (end < numbers.size() && numbers[end] == numbers[begin]) ++end;
        most = std::max(most, end - begin);
    }
    return most;
}

}  // namespace

Vector3 ContactNormal(const BodyStore& bodies, const PairStore& pairs, uint32_t index) {
    const Pair& pair = pairs.pairs[index];
    const float(&n)[3] = pairs.RecordOf(pair).normal;
    return Rotate(bodies.RotationOf(pair.bodyA), Vector3(n[0], n[1], n[2]));
}

RelativePose WithDistinctCenters(const BodyStore& bodies, const ColliderStore& colliders, const Pair& pair,
                                 PairShapes shapes, const RelativePose& bInA) {
    const float offset = kCenterOffset * (shapes.a.InnerRadius() + shapes.b.InnerRadius());
    if (LengthSquared(bInA.position) > offset * offset) return bInA;
    Vector3 away = PointInBall(pair.bodyB) - PointInBall(pair.bodyA);
    away = InverseRotate(bodies.RotationOf(pair.bodyA), away);
    if (pair.offset) away = InverseRotate(colliders.shapes[pair.colliderA].local.rotation, away);
    return {bInA.position + Normalized(away, Vector3(0, 1, 0)) * offset, bInA.rotation};
}

void NoteOverlap(const CollideStores& stores, uint32_t index, PairShapes shapes, const RelativePose& bInA,
                 WorkerFindings& findings) {
    const BodyStore& bodies = stores.bodies;
    const Pair& pair = stores.pairs.pairs[index];
    if (!pair.fixedB && shapes.b.IsConvex()) {
        const float deep = DeepOverlapDistance(shapes.a, shapes.b);
        if (LengthSquared(bInA.position) < deep * deep)
            for (const uint32_t body : {pair.bodyA, pair.bodyB}) findings.deepOverlaps.push_back(body);
    }
    const BodyDynamics &a = bodies.dynamics[pair.bodyA], &b = bodies.dynamics[pair.bodyB];
    const bool isPlaced = !bodies.placed.empty() && (bodies.cold[pair.bodyA].placed || bodies.cold[pair.bodyB].placed);
    if (!isPlaced && a.crowded == 0 && b.crowded == 0) return;
    const float radii = shapes.a.InnerRadius() + (pair.fixedB ? 0.0f : shapes.b.InnerRadius());
    const DeepestPoint deepest =
        DeepestPointOf(bodies, stores.pairs, index, ContactNormal(bodies, stores.pairs, index));
    const bool overlaps = deepest.separation < -kSeparatedOverlap * radii,
               overlapsDeeply = deepest.separation < -kLoadedOverlap * radii;
    // A fast approach is an impact, not a placement, and is solved normally.
    const bool wasPut = isPlaced && deepest.separation < -kCrowdedOverlap * radii &&
                        deepest.approach < stores.step.settings.depenetrationSpeed;
    const auto note = [&](uint32_t body, uint8_t level, uint8_t levelOfOther) {
        if (level == 0 && !wasPut) return;
        const auto add = [&](uint32_t now) { findings.crowdedOverlaps.push_back(body << kLevelBits | now); };
        if (overlapsDeeply) return add(kOverlapsDeeply);
        if (overlaps) add(kOverlaps);
        if (levelOfOther > 1) add(levelOfOther - 1u);
    };
    note(pair.bodyA, a.crowded, b.crowded);
    if (!pair.fixedB) note(pair.bodyB, b.crowded, a.crowded);
}

void GatherCrowd(const StepContext& step, BodyStore& bodies, CrowdState& crowd, std::span<WorkerFindings> workers) {
    bodies.ForgetPlaced();
    for (const uint32_t body : crowd.crowded) bodies.dynamics[body].crowded = 0;
    Array<uint32_t>& noted = crowd.crowded;
    Gather(workers, &WorkerFindings::crowdedOverlaps, noted);
    Array<SettlingBody>& settling = crowd.settling;
    crowd.settled.swap(settling);
    settling.clear();
    std::span<const SettlingBody> earlier = crowd.settled;
    size_t kept = 0;
    for (size_t begin = 0, end = 0; begin < noted.size(); begin = end) {
        const uint32_t body = BodyOf(noted[begin]);
        uint32_t level = 0;  // of those below kOverlaps
        for (; end < noted.size() && BodyOf(noted[end]) == body; ++end)
            if (LevelOf(noted[end]) < kOverlaps) level = LevelOf(noted[end]);
        if (const uint32_t most = LevelOf(noted[end - 1]); most == kOverlapsDeeply) {
            level = kOverlaps;
        } else if (most == kOverlaps) {
            settling.push_back({body, SecondsSettled(earlier, body) + step.dt});
            if (settling.back().seconds < kSettlingSeconds) level = kOverlaps;
        }
        if (level == 0) continue;
        bodies.dynamics[body].crowded = level & kOverlaps;
        noted[kept++] = body;
    }
    noted.resize(kept);
    for (const DispersingBody& dispersing : crowd.dispersing) {
        bodies.dynamics[dispersing.body].crowded = kOverlaps;
        noted.push_back(dispersing.body);
    }
    Gather(workers, &WorkerFindings::deepOverlaps, crowd.deepOverlaps);
    if (MostRepeated(crowd.deepOverlaps) < kManyOverlaps) crowd.deepOverlaps.clear();
}

void LimitPush(const SystemSettings& settings, const ColliderStore& colliders, const PairStore& pairs,
               BodyStore& bodies, uint32_t body, float h) {
    const auto& free = bodies.unconstrained[body].row;
    const Vector3 freeV = VectorAt<BodyState::kLinear>(free), freeW = VectorAt<BodyState::kAngular>(free);
    const Vector3 push = bodies.LinearVelocityOf(body) - freeV, spin = bodies.AngularVelocityOf(body) - freeW;
    const float fastest = settings.contactPushSpeed;
    Vector3 v = LimitedPush(freeV, push, fastest);
    const Vector3 w = LimitedPush(freeW, spin, fastest / bodies.dynamics[body].outerRadius);
    const float(&moved)[3] = bodies.states[body].deltaPosition;
    VisitImmovableContacts(bodies, colliders, pairs, body, [&](uint32_t pair) {
        const Vector3 normal = ContactNormal(bodies, pairs, pair);
        const float gap = DeepestPointOf(bodies, pairs, pair, normal).separation -
                          Dot<float>(normal, Vector3(moved[0], moved[1], moved[2]));
        const float most = gap >= 0 ? gap / h : std::max(gap * kImmovableOverlapRemoved / h, -fastest);
        const float into = Dot<float>(normal, Vector3(v - bodies.LinearVelocityOf(pairs.pairs[pair].bodyB)));
        if (into > most) v -= normal * (into - most);
    });
    bodies.SetVelocity(body, v, w);
}

}  // namespace fulcrum
