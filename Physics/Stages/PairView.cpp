#include <Fulcrum/Physics/Stages/PairView.h>

#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>

namespace fulcrum {

namespace {

// A manifold is kept up to this relative motion since it was found.
constexpr float kKeptDistance = 1e-3f;  // m, but at most this fraction of the smaller body's size:
constexpr float kKeptFraction = 2e-3f;
constexpr float kKeptAngle = 1e-3f;  // rad

// Impulses are kept for warm starting if the cosine of the angle between the normals of two steps is at least this.
constexpr float kSameNormal = 0.5f;

// Points are stored relative to the bodies, the narrow phase computes them relative to the shapes.
Vector3 ToBody(const CollideStores& stores, const Pair& pair, uint32_t collider, const Vector3& point) {
    return pair.offset ? LocalOf(stores.bodies, stores.colliders, collider).Transform(point) : point;
}

Vector3 DirectionFromBody(const CollideStores& stores, const Pair& pair, const Vector3& direction) {
    return pair.offset ? InverseRotate(LocalOf(stores.bodies, stores.colliders, pair.colliderA).rotation, direction)
                       : direction;
}

void WriteTwistRadius(ContactRecord& record) {
    const Vector3 normal(record.normal[0], record.normal[1], record.normal[2]);
    const Vector3 t1 = Perpendicular(normal), t2 = Cross<float>(normal, t1);
    const int count = static_cast<int>(record.pointCount);
    Vector3 center = Vector3::Zero();
    for (int i = 0; i < count; ++i)
        center += Vector3(record.points[i].onA[0], record.points[i].onA[1], record.points[i].onA[2]);
    center = center * (1.0f / static_cast<float>(count));
    float x[ContactRecord::kMaxPoints], y[ContactRecord::kMaxPoints];
    for (int i = 0; i < count; ++i) {
        const Vector3 r = Vector3(record.points[i].onA[0], record.points[i].onA[1], record.points[i].onA[2]) - center;
        x[i] = Dot<float>(r, t1);
        y[i] = Dot<float>(r, t2);
    }
    record.twistRadius = MeanDistance(x, y, count);
}

void ForgetFriction(ContactRecord& record) {
    record.twistImpulse = 0;
    for (float& f : record.frictionImpulse) f = 0;
}

bool IsUsable(const Vector3& normal) { return std::fabs(LengthSquared(normal) - 1) < 0.1f; }

// Whether the contact normal changed direction. The impulses of the last step along the new normal would then no longer
// balance the bodies' other contacts, and opposite contacts of a body in a thin floor would throw it out. A rolling
// body keeps its normal in the other one's frame. Normals are in the frame of shape A.
bool NormalTurned(const PairView& v, const RelativePose& reference, const Vector3& before, const Vector3& now) {
    if (Dot<float>(before, now) >= kSameNormal) return false;
    return Dot<float>(InverseRotate(reference.rotation, before), InverseRotate(v.bInA.rotation, now)) < kSameNormal;
}

// Clears the manifold.
void Forget(Pair& pair, ContactRecord& record) {
    if (pair.pointCount == 0) ForgetFriction(record);
    record.pointCount = 0;
    pair.pointCount = 0;
}

}  // namespace

PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t index) {
    Pair& pair = pairs.pairs[index];
    const RelativePose bInA = Relative(bodies.CenterPoseOf(pair.bodyA), bodies.CenterPoseOf(pair.bodyB));
    PairView view{pair, bInA, bInA};
    if (pair.offset)
        view.bInA =
            Inverse(LocalOf(bodies, colliders, pair.colliderA)) * bInA * LocalOf(bodies, colliders, pair.colliderB);
    return view;
}

bool HardlyMoved(const PairView& v, const PairContact& contact) {
    const RelativePose& old = contact.reference;
    const float size = std::min(v.pair.shapeA->OuterRadius(), v.pair.shapeB->OuterRadius());
    const float distance = std::min(kKeptDistance, kKeptFraction * size);
    if (LengthSquared(Vector3(v.bInA.position - old.position)) > distance * distance) return false;
    // For small angles |q - q0| is half the angle; the quaternion's sign does not flip between two steps.
    const Quaternion& a = v.bInA.rotation;
    const Quaternion& b = old.rotation;
    const Quaternion d{a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
    return LengthSquared(d) <= 0.25f * kKeptAngle * kKeptAngle;
}

float FarEndFactor(const ConstraintColoring& coloring, const Pair& pair) {
    const bool touches = coloring.IsTouched(pair.bodyA) || (!pair.fixedB && coloring.IsTouched(pair.bodyB));
    return touches ? 2.0f : 1.0f;
}

void WriteManifold(const CollideStores& stores, const PairView& v, const Manifold& manifold, PairContact& contact,
                   ContactRecord& record) {
    Pair& pair = v.pair;
    const Vector3 normal =
        pair.offset ? Rotate(stores.colliders.shapes[pair.colliderA].local.rotation, manifold.normal) : manifold.normal;
    // With extreme sizes or distances any pair function may overflow: such results are discarded.
    const bool isUsable = manifold.pointCount == 0 || IsUsable(normal);
    if (!isUsable) pair.cache = {};
    if (manifold.pointCount == 0 || !isUsable) return Forget(pair, record);
    const Vector3 oldNormal(record.normal[0], record.normal[1], record.normal[2]);
    const bool goesOn =
        pair.pointCount > 0 &&
        !NormalTurned(v, contact.reference, DirectionFromBody(stores, pair, oldNormal), manifold.normal);
    for (int k = 0; k < 3; ++k) record.normal[k] = normal[k];
    float oldImpulses[Manifold::kMaxPoints];
    std::copy(record.impulse, record.impulse + Manifold::kMaxPoints, oldImpulses);
    const int oldCount = goesOn ? pair.pointCount : 0;
    uint32_t oldFeatures[Manifold::kMaxPoints];
    std::copy(contact.features, contact.features + Manifold::kMaxPoints, oldFeatures);

    // Velocity of B relative to A, in A's frame.
    const BodyStore& bodies = stores.bodies;
    const Quaternion toWorld = bodies.RotationOf(pair.bodyA);
    const auto inA = [&](const Vector3& world_) { return InverseRotate(toWorld, world_); };
    const Vector3 vA = inA(bodies.LinearVelocityOf(pair.bodyA)), wA = inA(bodies.AngularVelocityOf(pair.bodyA));
    const Vector3 vB = inA(bodies.LinearVelocityOf(pair.bodyB)), wB = inA(bodies.AngularVelocityOf(pair.bodyB));

    const float farEnd = FarEndFactor(stores.coloring, pair),
                speculative = SpeculativeDistance(stores.step.settings, pair);
    int count = 0;
    for (int i = 0; i < manifold.pointCount; ++i) {
        const ManifoldPoint& found = manifold.points[i];
        const Vector3 onA = ToBody(stores, pair, pair.colliderA, found.positionOnA);
        const Vector3 pointOfB = onA + normal * found.separation;  // in A's frame
        if (!IsFinite(pointOfB)) continue;
        const float ofA = Dot<float>(normal, Vector3(vA + Cross<float>(wA, onA)));
        const float ofB = -Dot<float>(normal, Vector3(vB + Cross<float>(wB, Vector3(pointOfB - v.bodyBInA.position))));
        // One of the two may be stopped by another body.
        const float approach = std::max(ofA + ofB, std::max(ofB, pair.fixedB ? 0.0f : ofA));
        if (found.separation > speculative + farEnd * std::max(approach, 0.0f) * stores.step.dt) continue;
        const Vector3 onB = v.bodyBInA.InverseTransform(pointOfB);
        for (int k = 0; k < 3; ++k) {
            record.points[count].onA[k] = onA[k];
            record.points[count].onB[k] = onB[k];
        }
        record.impulse[count] = 0;
        for (int j = 0; j < oldCount; ++j)
            if (oldFeatures[j] == found.feature) record.impulse[count] = oldImpulses[j];
        contact.features[count++] = found.feature;
    }
    record.pointCount = static_cast<float>(count);
    pair.pointCount = static_cast<uint8_t>(count);
    if (oldCount == 0) ForgetFriction(record);
    if (count > 0) WriteTwistRadius(record);
}

PairChange NoteTouching(const CollideStores& stores, uint32_t index, WorkerFindings& findings) {
    Pair& pair = stores.pairs.pairs[index];
    const bool touched = pair.touching;
    pair.touching = pair.pointCount > 0 &&
                    (!stores.step.listener ||
                     AskListener(*stores.step.listener, stores.bodies, stores.colliders, stores.pairs, index));
    findings.contacts += pair.touching;
    findings.points += pair.touching ? pair.pointCount : 0;
    if (pair.touching == touched) return PairChange::None;
    return pair.touching ? PairChange::Began : PairChange::Ended;
}

bool TouchesSleepingBody(const BodyStore& bodies, const Pair& pair) {
    const auto sleeps = [&](uint32_t body) {
        const BodyDynamics& d = bodies.dynamics[body];
        return d.motion == MotionType::Dynamic && !d.awake;
    };
    return pair.touching && (sleeps(pair.bodyA) || sleeps(pair.bodyB));
}

}  // namespace fulcrum
