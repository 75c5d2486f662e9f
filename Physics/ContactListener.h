// What a user's code has a say in: which bodies make contact, and how a contact behaves: belts, one-way platforms, ice
// under one kind of tyre. Derive from ContactListener and hand it to PhysicsSystem::SetContactListener. Called within a
// step, from several threads at once, in no order: everything it answers must follow from its arguments and from what
// the step does not change (settings of its own, bodies' poses, velocities and user data, which are those at the start
// of the step). Then the results are the same for any number of threads. It may read Bodies(). Queries find nothing
// there and are reported (Misuse.h), changes of the world are refused with an error.
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
        float impulse;      // N s, along the normal, of the last substep that was solved
    };
    std::span<const Point> points;    // 1..4
    uint32_t childA = 0, childB = 0;  // the pieces of compounds; else 0

    // m; the mean of the points.
    Position Center() const;
};

// How a contact is to behave in this step.
struct ContactChange {
    // As the two materials give them in every step anew. A value out of range, or not finite, changes nothing.
    float friction, restitution;  // >= 0; 0..1
    // B's surface moves against A's beyond the motion of the bodies: so fast at the contact's center (m/s, world axes),
    // and turning so fast (rad/s, world axes). Friction makes what touches keep up with it. Only the part along the
    // contact counts, and the turn about the normal. Not finite: none.
    Vector3 surfaceVelocity = Vector3::Zero(), surfaceTurn = Vector3::Zero();
    // For this contact the bodies are so much lighter or heavier; only the dynamic ones count. One of its four scales
    // out of range, or not finite: none. Momentum is that of the masses as they are here, so that of the world changes.
    MassOverride massOverride{};
    // No contact in this step: nothing bounces, wakes or rests.
    bool ignore = false;

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
