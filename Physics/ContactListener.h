// User callbacks for contacts: whether two bodies collide, and how a contact behaves (conveyor belts, one-way
// platforms, friction per tire). Derive from ContactListener and pass it to PhysicsSystem::SetContactListener. Called
// during a step, from several threads at once, in no particular order. For results to be deterministic, callbacks may
// depend only on their arguments and on data that the step does not change: members of the listener; poses, velocities
// and user data of bodies, which are those at the start of the step. Callbacks may read Bodies(). Queries find nothing
// there and are reported (Misuse.h); changes of the world return an error.
#pragma once

#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>

namespace fulcrum {

// One touching pair of convex shapes: a manifold.
struct ContactView {
    BodyId bodyA, bodyB;  // A is dynamic, B of any kind
    Vector3 normal;       // unit, world, from A to B
    struct Point {
        Position position;  // m, on A's surface
        float separation;   // m, negative for overlap
        float impulse;      // N s, along the normal, of the last solved substep; for whole steps see StepEvents.h
    };
    std::span<const Point> points;    // 1..4
    uint32_t childA = 0, childB = 0;  // children of compounds; else 0

    // m; the mean of the points.
    Position Center() const;
};

// Properties of a contact in this step.
struct ContactChange {
    // Set from the two materials before every call. A value out of range or not finite is ignored.
    float friction, restitution;  // 0..1e6; 0..1
    // Surface velocity of B relative to A in addition to the motion of the bodies (conveyor belt): m/s at the contact's
    // center, and rad/s, world axes. It changes the slip velocity of friction. Only its components in the contact plane
    // and the rotation about the normal are used. Ignored if not finite.
    Vector3 surfaceVelocity = Vector3::Zero(), surfaceAngularVelocity = Vector3::Zero();
    // Mass scales of the two bodies in this contact; ignored for static and kinematic bodies, and if out of range or
    // not finite. The contact conserves momentum computed with the scaled masses, not the real one.
    MassOverride massOverride{};
    // Disables the contact in this step: no impulses, and it neither wakes nor supports bodies.
    bool ignore = false;
    // No impulses, as with `ignore`, but the contact is among the events of the step, with its points. Continuous
    // collision passes through it.
    bool isSensor = false;

    // Gives the surface of `belt`, one of the two bodies, a velocity (m/s, world axes) relative to its body.
    void MoveSurface(const ContactView& contact, BodyId belt, const Vector3& velocity);
    // The same for a surface that rotates about a pivot (m, world) with the angular velocity (rad/s, world axes): a
    // curved belt.
    void RotateSurface(const ContactView& contact, BodyId belt, const Position& pivot, const Vector3& angularVelocity);
    // Multiplies the inverse mass and inertia of `body`, one of the two bodies: see MassOverride.
    void ScaleInverseMass(const ContactView& contact, BodyId body, float scale);
};

class ContactListener {
public:
    virtual ~ContactListener() = default;

    // Whether two bodies collide at all; a.index < b.index. Called when their bounds, or those of two of their
    // children, begin to overlap, or one of them wakes, but not for existing pairs: to have these checked again, call
    // SetContactListener again.
    virtual bool ShouldCollide(BodyId, BodyId) const { return true; }

    // Called in every step for every contact that touches, or may touch within the step, and has an awake body, also if
    // the points are those of the last step. Changes hold for one step; defaults are computed from the materials. Also
    // called for hits of continuous collision within the step, with the poses and velocities of that moment. Not called
    // for sleeping bodies: wake those on a belt that starts to move. Bodies in contact with a moving surface do not
    // fall asleep.
    virtual void ModifyContact(const ContactView&, ContactChange&) const {}
};

}  // namespace fulcrum
