#include <Fulcrum/Physics/Stages/PairView.h>

#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

// A manifold is kept up to this relative motion since it was found.
constexpr float kKeptDistance = 1e-3f;  // m, but at most this fraction of the smaller body's size:
constexpr float kKeptFraction = 2e-3f;
constexpr float kKeptAngle = 1e-3f;  // rad
// Normals rotate with body A. Of what rolls they would lean forward until the manifold is found anew, so that slow
// balls would accelerate on a level floor.
constexpr float kKeptAngleOfRound = 2e-5f;

// Impulses are kept for warm starting if the cosine of the angle between the normals of two steps is at least this.
constexpr float kSameNormal = 0.5f;

bool IsRound(const Shape& shape) {
    switch (shape.Type()) {
        case ShapeType::Sphere:
        case ShapeType::Capsule:
        case ShapeType::TaperedCapsule:
        case ShapeType::Cylinder:
        case ShapeType::Custom: return true;
        default: return false;
    }
}

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

bool IsUsable(const Vector3& normal) { return std::fabs(LengthSquared(normal) - 1) < 0.1f; }

// Whether the contact normal changes direction. The impulses of the last step along the new normal would then no longer
// balance the bodies' other contacts, and opposite contacts of a body in a thin floor would throw it out. A rolling
// body keeps its normal in the other one's frame. Normals are in the frame of shape A.
bool Turns(const CollideStores& stores, const PairView& v, const Manifold& manifold, const PairContact& contact,
           const ContactRecord& record) {
    const Vector3 before = DirectionFromBody(stores, v.pair, {record.normal[0], record.normal[1], record.normal[2]});
    const Vector3& now = manifold.normal;
    if (Dot<float>(before, now) >= kSameNormal) return false;
    return Dot<float>(InverseRotate(contact.reference.rotation, before), InverseRotate(v.bInA.rotation, now)) <
           kSameNormal;
}

// Whether the bounding spheres of two bodies are farther apart than `distance`.
bool BallsApart(const CollideStores& stores, const Pair& pair, PairShapes shapes, float distance) {
    const Vector3 between = stores.OffsetOf(pair.bodyA, pair.bodyB);
    const float reach = shapes.a.OuterRadius() + shapes.b.OuterRadius() + distance;
    return LengthSquared(between) > reach * reach;
}

// m: how much closer the bounding spheres of two pieces may get within the step, also if one of them is stopped at its
// start.
float ClosingMotion(const CollideStores& stores, const Pair& pair) {
    const BodyStore& bodies = stores.bodies;
    Vector3 vA = bodies.LinearVelocityOf(pair.bodyA), vB = bodies.LinearVelocityOf(pair.bodyB);
    if (pair.offset) {
        const auto ofArm = [&](uint32_t body, uint32_t collider) {
            return Cross<float>(
                bodies.AngularVelocityOf(body),
                Rotate(bodies.RotationOf(body), LocalOf(stores.bodies, stores.colliders, collider).position));
        };
        vA += ofArm(pair.bodyA, pair.colliderA);
        vB += ofArm(pair.bodyB, pair.colliderB);
    }
    float fastest = std::max(LengthSquared(Vector3(vB - vA)), LengthSquared(vB));
    if (!pair.fixedB) fastest = std::max(fastest, LengthSquared(vA));
    if (stores.IsSecondPass()) {
        const auto most = [&](const Vector3& v, uint32_t body) {
            const Deflection* deflection = stores.DeflectionOf(body);
            return deflection ? std::max(Length(v), Length(Vector3(v + deflection->linear))) : Length(v);
        };
        return stores.step.dt * (most(vA, pair.bodyA) + most(vB, pair.bodyB));
    }
    return stores.step.dt * Sqrt(fastest);
}

// m: how much farther two pieces may extend by rotating within the step; convex ones at most to their bounding spheres.
// For a rotating surface, the part near the other piece counts.
float TurningMotion(const CollideStores& stores, const Pair& pair, PairShapes shapes) {
    const auto angleOf = [&](uint32_t body) {
        const Deflection* deflection = stores.DeflectionOf(body);
        return stores.step.dt *
               (Length(stores.bodies.AngularVelocityOf(body)) + (deflection ? Length(deflection->angular) : 0.0f));
    };
    const auto ofConvex = [&](uint32_t body, const Shape& shape) {
        const float outer = shape.OuterRadius();
        return std::min(angleOf(body) * outer, outer - shape.InnerRadius());
    };
    const float ofA = ofConvex(pair.bodyA, shapes.a);
    if (shapes.b.IsConvex()) return ofA + ofConvex(pair.bodyB, shapes.b);
    const float angle = angleOf(pair.bodyB);
    if (!(angle > 0)) return ofA;
    const Vector3 between = (stores.bodies.CenterOf(pair.bodyB) - stores.bodies.CenterOf(pair.bodyA)).cast<float>();
    return ofA + angle * std::min(shapes.b.OuterRadius(), Length(between) + shapes.a.OuterRadius());
}

// m: contacts farther away than this are left to the Continuous stage.
float MotionBeforeCast(const CollideStores& stores, const Pair& pair, PairShapes shapes) {
    float motion = std::numeric_limits<float>::infinity();
    if (stores.bodies.dynamics[pair.bodyA].continuous)
        motion = FreeMotion(shapes.a.InnerRadius(), shapes.a.OuterRadius());
    if (stores.bodies.dynamics[pair.bodyB].continuous)
        motion = std::min(motion, FreeMotion(shapes.b.InnerRadius(), shapes.b.OuterRadius()));
    return motion;
}

PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, Pair& pair, const RelativePose& bInA) {
    PairView view{pair, ShapesOf(colliders, pair), bInA, bInA};
    if (pair.offset)
        view.bInA =
            Inverse(LocalOf(bodies, colliders, pair.colliderA)) * bInA * LocalOf(bodies, colliders, pair.colliderB);
    return view;
}

// m and rad, of a body until the stores' time.
Twist<float> DisplacementOf(const CollideStores& stores, uint32_t body) {
    const BodyStore& bodies = stores.bodies;
    if (!bodies.CanMove(body))
        return {bodies.LinearVelocityOf(body) * stores.elapsed, bodies.AngularVelocityOf(body) * stores.elapsed};
    const float(&moved)[3] = bodies.states[body].deltaPosition, (&turned)[3] = bodies.states[body].deltaRotation;
    return {Vector3(moved[0], moved[1], moved[2]), Vector3(turned[0], turned[1], turned[2])};
}

// Whether one of two bodies rotates so far in the step that it will collide again within it (Recollide.h). Beyond a
// radian the points of the first substep would be far from the truth.
bool WillCollideAgain(const CollideStores& stores, const Pair& pair, PairShapes shapes) {
    const auto will = [&](uint32_t body, const Shape& shape) {
        const float dt = stores.step.dt, square = LengthSquared(stores.bodies.AngularVelocityOf(body)) * dt * dt;
        return square * shape.OuterRadius() > 2 * kMostDeviation * shape.InnerRadius() && square < 1;
    };
    return will(pair.bodyA, shapes.a) || (!pair.fixedB && will(pair.bodyB, shapes.b));
}

// What stops the approach of two bodies within the step.
struct Hit {
    float speed = 0;                // m/s: of the approach, less what closes the gap in the step
    Vector3 onA = Vector3::Zero();  // m, the point, in A's frame
};

// Bodies that move by less in the step than this fraction of their inner radius are not deflected.
constexpr float kLeastDeflection = 0.1f;

// normal: unit, in A's frame, from A to B.
void NoteDeflections(const CollideStores& stores, const PairView& v, const Vector3& normal, const Hit& hit,
                     WorkerFindings& findings) {
    const float motion = hit.speed * stores.step.dt;
    if (!(motion > kLeastDeflection * std::min(v.shapes.a.InnerRadius(), v.shapes.b.InnerRadius()))) return;
    const BodyStore& bodies = stores.bodies;
    const Quaternion toWorld = stores.RotationOf(v.pair.bodyA);
    const Vector3 n = Rotate(toWorld, normal);
    const int count = v.pair.fixedB ? 1 : 2;
    const uint32_t body[2] = {v.pair.bodyA, v.pair.bodyB};
    Vector3 turn[2];  // angular velocity by a unit impulse
    float response = 0;
    for (int i = 0; i < count; ++i) {
        const Vector3 arm = Rotate(toWorld, i == 0 ? hit.onA : Vector3(hit.onA - v.bodyBInA.position));
        const Vector3 torque = Cross<float>(arm, n);
        turn[i] = bodies.masses[body[i]].InverseInertia() * torque;
        response += bodies.masses[body[i]].inverseMass + Dot<float>(torque, turn[i]);
    }
    if (!(response > 0)) return;
    for (int i = 0; i < count; ++i) {
        const float impulse = (i == 0 ? -hit.speed : hit.speed) / response;
        const Shape& shape = i == 0 ? v.shapes.a : v.shapes.b;
        const Vector3 linear = n * (impulse * bodies.masses[body[i]].inverseMass), angular = turn[i] * impulse;
        const float size = Length(linear) + Length(angular) * shape.OuterRadius();
        if (std::isfinite(size) && size * stores.step.dt > kLeastDeflection * shape.InnerRadius())
            findings.deflections.push_back({body[i], body[1 - i], linear, angular, size});
    }
}

// Clears the manifold.
void Forget(Pair& pair, ContactRecord& record) {
    if (pair.pointCount == 0) record.ForgetFriction();
    record.pointCount = 0;
    pair.pointCount = 0;
}

}  // namespace

Quaternion CollideStores::RotationOf(uint32_t body) const {
    const Quaternion before = bodies.RotationOf(body);
    if (elapsed == 0) return before;
    return Normalized(TurnOf(DisplacementOf(*this, body).angular) * before);
}

Vector3 CollideStores::OffsetOf(uint32_t bodyA, uint32_t bodyB) const {
    Position offset = bodies.CenterOf(bodyB) - bodies.CenterOf(bodyA);
    if (elapsed > 0)
        offset += (DisplacementOf(*this, bodyB).linear - DisplacementOf(*this, bodyA).linear).cast<double>();
    return offset.cast<float>();
}

PairView ViewPair(const CollideStores& stores, uint32_t index) {
    Pair& pair = stores.pairs.pairs[index];
    const Quaternion ofA = stores.RotationOf(pair.bodyA), ofB = stores.RotationOf(pair.bodyB);
    return ViewPair(stores.bodies, stores.colliders, pair,
                    {InverseRotate(ofA, stores.OffsetOf(pair.bodyA, pair.bodyB)), ofA.Conjugate() * ofB});
}

PairView ViewPair(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, uint32_t index) {
    Pair& pair = pairs.pairs[index];
    return ViewPair(bodies, colliders, pair,
                    Relative(bodies.CenterPoseOf(pair.bodyA), bodies.CenterPoseOf(pair.bodyB)));
}

bool HardlyMoved(const PairView& v, const PairContact& contact) {
    const RelativePose& old = contact.reference;
    const float size = std::min(v.shapes.a.OuterRadius(), v.shapes.b.OuterRadius());
    const float distance = std::min(kKeptDistance, kKeptFraction * size);
    if (LengthSquared(Vector3(v.bInA.position - old.position)) > distance * distance) return false;
    // For small angles |q - q0| is half the angle; the quaternion's sign does not flip between two steps.
    const Quaternion& a = v.bInA.rotation;
    const Quaternion& b = old.rotation;
    const Quaternion d{a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
    const float squared = 4 * LengthSquared(d);
    if (squared <= kKeptAngleOfRound * kKeptAngleOfRound) return true;
    return squared <= kKeptAngle * kKeptAngle && !IsRound(v.shapes.a) && !IsRound(v.shapes.b);
}

float FarEndFactor(const ConstraintColoring& coloring, const Pair& pair) {
    const bool touches = coloring.IsTouched(pair.bodyA) || (!pair.fixedB && coloring.IsTouched(pair.bodyB));
    return touches ? 2.0f : 1.0f;
}

PairReach::PairReach(const CollideStores& stores, const Pair& pair, PairShapes shapes)
    : speculative_(SpeculativeDistance(stores.step.settings, shapes)),
      closing_(FarEndFactor(stores.coloring, pair) * ClosingMotion(stores, pair)),
      mostMotion_(stores.bodies.continuousCount > 0 ? MotionBeforeCast(stores, pair, shapes)
                                                    : std::numeric_limits<float>::infinity()) {}

bool PairReach::AreFarApart(const CollideStores& stores, const Pair& pair, PairShapes shapes) const {
    return BallsApart(stores, pair, shapes, Of(closing_));
}

float PairReach::WithRotation(const CollideStores& stores, const Pair& pair, PairShapes shapes) const {
    return Of(closing_ + TurningMotion(stores, pair, shapes));
}

void FindManifold(const CollideStores& stores, const PairView& view, float reach, Manifold& manifold,
                  WorkerFindings& findings) {
    Pair& pair = view.pair;
    CollideSettings settings;
    settings.method = stores.step.settings.narrowPhase;
    settings.speculativeDistance = reach;
    if (view.shapes.b.Type() == ShapeType::Plane)
        Collide(view.shapes.a, static_cast<const Plane&>(view.shapes.b), view.bInA, settings, pair.cache, manifold,
                findings.libccd);
    else
        Collide(view.shapes.a, static_cast<const ConvexShape&>(view.shapes.b),
                WithDistinctCenters(stores.bodies, stores.colliders, pair, view.shapes, view.bInA), settings,
                pair.cache, manifold, findings.libccd);
}

bool TurnsFromOthers(const CollideStores& stores, const PairView& view, const Manifold& manifold) {
    const Pair& pair = view.pair;
    if (!pair.offset || pair.pointCount == 0 || manifold.pointCount == 0) return false;
    const ContactRecord& record = stores.pairs.RecordOf(pair);
    return record.TotalImpulse() > 0 && Turns(stores, view, manifold, stores.pairs.contacts[pair.contact], record);
}

void WriteManifold(const CollideStores& stores, const PairView& v, const Manifold& manifold, PairContact& contact,
                   ContactRecord& record, WorkerFindings& findings) {
    Pair& pair = v.pair;
    const Vector3 normal =
        pair.offset ? Rotate(stores.colliders.shapes[pair.colliderA].local.rotation, manifold.normal) : manifold.normal;
    // With extreme sizes or distances any pair function may overflow: such results are discarded.
    const bool isUsable = manifold.pointCount == 0 || IsUsable(normal);
    if (!isUsable) pair.cache = {};
    if (manifold.pointCount == 0 || !isUsable) return Forget(pair, record);
    const bool goesOn = pair.pointCount > 0 && !Turns(stores, v, manifold, contact, record);
    for (int k = 0; k < 3; ++k) record.normal[k] = normal[k];
    float oldImpulses[Manifold::kMaxPoints];
    std::copy(record.impulse, record.impulse + Manifold::kMaxPoints, oldImpulses);
    const int oldCount = goesOn ? pair.pointCount : 0;
    uint32_t oldFeatures[Manifold::kMaxPoints];
    std::copy(contact.features, contact.features + Manifold::kMaxPoints, oldFeatures);

    // Velocity of B relative to A, in A's frame.
    const BodyStore& bodies = stores.bodies;
    const Quaternion toWorld = stores.RotationOf(pair.bodyA);
    const auto inA = [&](const Vector3& world_) { return InverseRotate(toWorld, world_); };
    const Vector3 vA = inA(bodies.LinearVelocityOf(pair.bodyA)), wA = inA(bodies.AngularVelocityOf(pair.bodyA));
    const Vector3 vB = inA(bodies.LinearVelocityOf(pair.bodyB)), wB = inA(bodies.AngularVelocityOf(pair.bodyB));

    // Speeds at the start of the step do not tell which points of fast rotating or deflected bodies may touch.
    const bool keepsAll = stores.elapsed > 0 || stores.IsSecondPass() || WillCollideAgain(stores, pair, v.shapes);
    const float farEnd = FarEndFactor(stores.coloring, pair),
                speculative = SpeculativeDistance(stores.step.settings, v.shapes);
    int count = 0;
    Hit hit;
    for (int i = 0; i < manifold.pointCount; ++i) {
        const ManifoldPoint& found = manifold.points[i];
        const Vector3 onA = ToBody(stores, pair, pair.colliderA, found.positionOnA);
        const Vector3 pointOfB = onA + normal * found.separation;  // in A's frame
        if (!IsFinite(pointOfB)) continue;
        const float ofA = Dot<float>(normal, Vector3(vA + Cross<float>(wA, onA)));
        const float ofB = -Dot<float>(normal, Vector3(vB + Cross<float>(wB, Vector3(pointOfB - v.bodyBInA.position))));
        // One of the two may be stopped by another body.
        const float approach = std::max(ofA + ofB, std::max(ofB, pair.fixedB ? 0.0f : ofA));
        const float excess = ofA + ofB - std::max(found.separation, 0.0f) / stores.step.dt;
        if (excess > hit.speed) hit = {excess, onA};
        if (!keepsAll && found.separation > speculative + farEnd * std::max(approach, 0.0f) * stores.step.dt) continue;
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
    std::fill(record.impulse + count, record.impulse + ContactRecord::kMaxPoints, 0.0f);
    record.pointCount = static_cast<float>(count);
    pair.pointCount = static_cast<uint8_t>(count);
    if (oldCount == 0) record.ForgetFriction();
    if (count > 0) WriteTwistRadius(record);
    if (stores.elapsed == 0 && !stores.IsSecondPass()) NoteDeflections(stores, v, normal, hit, findings);
}

bool IsFoundAgain(const CollideStores& stores, const Pair& pair, WorkerFindings& findings) {
    if (!stores.IsSecondPass() || !pair.touching || pair.pointCount == 0) return false;
    ++findings.contacts;
    findings.points += pair.pointCount;
    return true;
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
