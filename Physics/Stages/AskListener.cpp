// Calls the contact listener for a contact. Collide does so when it knows the points, before they have any effect: an
// ignored contact gets no color, wakes no body and costs the solver nothing.
#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Validation.h>
#include <Fulcrum/Physics/World/Materials.h>

namespace fulcrum {

namespace {

// World axes: the normal, and the offsets, m, of the current contact points on both surfaces from those when the
// manifold was found.
struct ContactAxes {
    Vector3 normal, besideA = Vector3::Zero(), besideB = Vector3::Zero();
};

ContactView View(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs, uint32_t index,
                 const ContactAxes& axes, ContactView::Point (&room)[ContactRecord::kMaxPoints]) {
    const Pair& pair = pairs.pairs[index];
    const ContactRecord& record = pairs.RecordOf(pair);
    const Pose poseA = bodies.CenterPoseOf(pair.bodyA), poseB = bodies.CenterPoseOf(pair.bodyB);
    for (size_t i = 0; i < pair.pointCount; ++i) {
        const ContactRecord::Point& p = record.points[i];
        const Position onA = poseA.Transform(Vector3(p.onA[0], p.onA[1], p.onA[2])) + axes.besideA.cast<double>();
        const Position onB = poseB.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2])) + axes.besideB.cast<double>();
        room[i] = {onA, Dot<float>(axes.normal, Vector3((onB - onA).cast<float>())), record.impulse[i]};
    }
    return {bodies.IdOf(pair.bodyA),
            bodies.IdOf(pair.bodyB),
            axes.normal,
            std::span<const ContactView::Point>(room, pair.pointCount),
            ChildOf(bodies, colliders, pair.colliderA),
            ChildOf(bodies, colliders, pair.colliderB)};
}

}  // namespace

ContactView ViewContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs, uint32_t index,
                        ContactView::Point (&room)[ContactRecord::kMaxPoints]) {
    return View(bodies, colliders, pairs, index, {ContactNormal(bodies, pairs, index)}, room);
}

// The normal rotates with neither body: it is taken from the body that rotated less. A rolling round shape touches with
// another point of its surface.
ContactView ViewSolvedContact(const BodyStore& bodies, const ColliderStore& colliders, const PairStore& pairs,
                              uint32_t index, ContactView::Point (&room)[ContactRecord::kMaxPoints]) {
    const Pair& pair = pairs.pairs[index];
    const float* n = pairs.RecordOf(pair).normal;
    Quaternion bInA =
        pairs.contacts[pair.contact].reference.rotation;  // relative rotation of the bodies when the normal was found
    if (pair.offset)
        bInA = LocalOf(bodies, colliders, pair.colliderA).rotation * bInA *
               LocalOf(bodies, colliders, pair.colliderB).rotation.Conjugate();
    const Vector3 ofA = ContactNormal(bodies, pairs, index),
                  ofB = Rotate(bodies.RotationOf(pair.bodyB), InverseRotate(bInA, Vector3(n[0], n[1], n[2])));
    const auto squaredTurn = [&](uint32_t body) { return LengthSquared(bodies.AngularVelocityOf(body)); };
    ContactAxes axes{squaredTurn(pair.bodyA) <= squaredTurn(pair.bodyB) ? ofA : ofB};
    const PairShapes shapes = ShapesOf(colliders, pair);
    axes.besideA = (axes.normal - ofA) * shapes.a.ConvexRadius();
    if (shapes.b.IsConvex())
        axes.besideB = (ofB - axes.normal) * static_cast<const ConvexShape&>(shapes.b).ConvexRadius();
    return View(bodies, colliders, pairs, index, axes, room);
}

ContactChange AskAbout(const ContactListener& listener, const ContactView& contact, float friction, float restitution) {
    ContactChange change{friction, restitution};
    listener.ModifyContact(contact, change);
    if (!(change.friction >= 0 && change.friction <= kMostFriction)) change.friction = friction;
    if (!(change.restitution >= 0 && change.restitution <= 1)) change.restitution = restitution;
    if (!IsFinite(change.surfaceVelocity) || !IsFinite(change.surfaceAngularVelocity)) {
        change.surfaceVelocity.setZero();
        change.surfaceAngularVelocity.setZero();
    }
    if (!change.massOverride.IsValid()) change.massOverride = {};
    return change;
}

bool AskListener(const ContactListener& listener, const BodyStore& bodies, const ColliderStore& colliders,
                 PairStore& pairs, uint32_t index) {
    const uint32_t contact = pairs.pairs[index].contact;
    ContactRecord& record = pairs.records[contact];
    ContactView::Point room[ContactRecord::kMaxPoints];
    const ContactView view = ViewContact(bodies, colliders, pairs, index, room);
    CombineMaterials(bodies, colliders, pairs, index);
    const ContactChange change = AskAbout(listener, view, record.friction, record.restitution);
    record.friction = change.friction;
    record.restitution = change.restitution;
    const Vector3 &linear = change.surfaceVelocity, &angular = change.surfaceAngularVelocity;
    record.Set(ContactRecord::kSurfaceVelocity, !(linear.isZero(0) && angular.isZero(0)));
    pairs.surfaceVelocities[contact] = {{linear[0], linear[1], linear[2]}, {angular[0], angular[1], angular[2]}};
    record.Set(ContactRecord::kMassOverride, !change.massOverride.IsNone());
    pairs.massOverrides[contact] = change.massOverride;
    record.Set(ContactRecord::kSensed, change.isSensor && !change.ignore);
    const bool acts = !change.ignore && !change.isSensor;
    if (!acts) record.ForgetImpulses();
    return acts;
}

}  // namespace fulcrum
