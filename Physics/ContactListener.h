// User callbacks for contacts: whether two bodies collide, and how a contact behaves (conveyor belts, one-way
// platforms, friction per tire). Derive from ContactListener and pass it to PhysicsSystem::SetContactListener. Called
// during a step, from several threads at once, in no order. An answer may depend only on the arguments and on what the
// step does not change (settings of the listener's own; poses, velocities and user data of bodies, which are those at
// the start of the step): then results are the same for any number of threads. Callbacks may read Bodies(). Queries
// find nothing there and are reported (Misuse.h); changes of the world are refused with an error.
#pragma once

#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>

namespace fulcrum {

// One touching pair of convex shapes: a manifold.
struct ContactView {
    BodyId bodyA, bodyB;  // A is dynamic, B any
    Vector3 normal;       // unit, world, from A to B
    struct Point {
        Position position;  // m, on A's surface
        float separation;   // m, negative where they overlap
        float impulse;      // N s, along the normal, of the last substep that was solved; StepEvents.h has whole steps'
    };
    std::span<const Point> points;    // 1..4
    uint32_t childA = 0, childB = 0;  // the pieces of compounds; else 0

    // m; the mean of the points.
    Position Center() const;
};

// How a contact is to behave in this step.
struct ContactChange {
    // Set from the two materials before every call. A value out of range or not finite is ignored.
    float friction, restitution;  // >= 0; 0..1
    // Surface velocity of B relative to A, beyond the motion of the bodies (conveyor belt): m/s at the contact's
    // center, and rad/s, world axes. Friction acts against the slip relative to it. Only the part along the contact
    // plane and the rotation about the normal count. Not finite: none.
    Vector3 surfaceVelocity = Vector3::Zero(), surfaceTurn = Vector3::Zero();
    // Mass scales of the two bodies in this contact; those of bodies that are not dynamic do not count. A scale out of
    // range or not finite: none. The contact conserves the momentum of the scaled masses, so not that of the world.
    MassOverride massOverride{};
    // No contact in this step: it gives no impulse, wakes nothing and supports nothing.
    bool ignore = false;
    // As ignored, but among the events of the step, with its points and without impulses. Continuous collision passes.
    bool isSensor = false;

    // The surface of `belt`, which is one of the two bodies, moves with the velocity (m/s, world axes) relative to its
    // body.
    void MoveSurface(const ContactView& contact, BodyId belt, const Vector3& velocity);
    // The same, turning about a pivot (m, world) with the angular velocity (rad/s, world axes): a belt's bend.
    void TurnSurface(const ContactView& contact, BodyId belt, const Position& pivot, const Vector3& angularVelocity);
    // The inverse mass and inertia of `body`, which is one of the two bodies, times this: see MassOverride.
    void ScaleInverseMass(const ContactView& contact, BodyId body, float scale);
};

class ContactListener {
public:
    virtual ~ContactListener() = default;

    // Whether two bodies collide at all; a.index < b.index. Asked when their bounds, or those of two pieces of them,
    // come to overlap, or one of them wakes, but not about two that collide already: to change an answer, call
    // SetContactListener again.
    virtual bool ShouldCollide(BodyId, BodyId) const { return true; }

    // Asked in every step for every contact that touches, or will within the step, with an awake body: also where
    // nothing moved and the points are those of the step before. An answer holds for one step: what it does not set
    // again is as the materials say. Continuous collision asks about what it hits in the middle of the step, when
    // velocities and poses are those that the step has come to. Bodies asleep are not asked about: wake those on a belt
    // that begins to run. What touches a surface that moves does not fall asleep.
    virtual void ModifyContact(const ContactView&, ContactChange&) const {}
};

}  // namespace fulcrum
