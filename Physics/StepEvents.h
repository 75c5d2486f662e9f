// Events of a step: contacts that began, persisted and ended, hits of continuous collision, bodies that moved, woke and
// fell asleep, joints that broke. From PhysicsSystem::Events. See Docs/Events.md.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>

#include <array>
#include <span>

namespace fulcrum {

// Contact of two colliders: convex shapes, planes, meshes or height fields. They touch in a step if there was an
// impulse between them or if they are in contact at its end; speculative contacts do not count. The contact ends when
// they have no impulse and are farther apart than a quarter of SystemSettings::speculativeDistance (as reduced for
// small shapes).
struct ContactEvent {
    enum class Kind : uint8_t {
        Begin,  // they touch, but did not in the last step
        Stay,   // they already did; contacts of sleeping bodies continue with this when they wake
        End,    // they no longer touch: separated, or a body was removed, teleported or filtered out
        Hit,    // continuous collision stopped or deflected one of them within the step
    };
    struct Point {
        Position position = Position::Zero();  // m, halfway between the two surfaces; at the end of the step, for a Hit
                                               // at its time
        float separation = 0;                  // m, along the normal; negative for overlap
        float impulse = 0;                     // N s along the normal, >= 0, of the whole step
    };
    // Points with one normal.
    struct Manifold {
        Vector3 normal = Vector3::Zero();           // unit, world, from A to B
        Vector3 frictionImpulse = Vector3::Zero();  // N s, world, on B, of the whole step; A got the opposite
        float twistImpulse = 0;                     // N m s about the normal, on B, likewise
        uint32_t triangle = 0;                      // if B is a mesh or a height field: of the deepest point
        uint32_t material = 0;                      // if B is one: index into its palette
        uint32_t pointCount = 0;                    // 1..4
        std::array<Point, 4> points{};              // the touching points; the first pointCount are valid

        std::span<const Point> Points() const { return {points.data(), pointCount}; }
    };

    BodyId bodyA, bodyB;              // A is dynamic; of two dynamic bodies, that with the lower index
    uint32_t childA = 0, childB = 0;  // children of compounds; else 0
    Kind kind = Kind::Begin;
    float time = 1;  // fraction of the step, 0..1; 1 except for a Hit
    // m/s, >= 0: largest approach speed of the points along the normal at the time of impact. Computed from the
    // velocities at the start of the step (for a Hit at its time), gravity and forces.
    float approachSpeed = 0;
    std::span<const Manifold> manifolds;  // none for End; maybe several if B is a mesh or a height field

    // N s: sum of the normal impulses of all points in the step.
    float NormalImpulse() const;
    // N s, world, on B: normal and friction impulses; A got the opposite.
    Vector3 Impulse() const;
};

struct BrokenJoint {
    JointId id;
    Vector3 force = Vector3::Zero(),
            torque = Vector3::Zero();  // N, N m: averages over the step, which exceeded a limit
};

// The order of all arrays is independent of the number of threads. Valid until the next step. A step of less than a
// nanosecond has no events; they are reported by the next.
struct StepEvents {
    // With EventSettings::contacts. By A, B, children, kind, time.
    std::span<const ContactEvent> contacts;
    // With EventSettings::bodies, by id. Awake at the end of the step: dynamic bodies, and kinematic ones that move.
    std::span<const BodyId> awake;
    // Bodies, awake or fallen asleep in this step, whose pose changed since the last step, or which are new.
    std::span<const BodyId> moved;
    // Bodies whose sleep state changed since the end of the last step; without new bodies.
    std::span<const BodyId> woke, fellAsleep;
    // Always, by id. They are disabled now.
    std::span<const BrokenJoint> brokenJoints;
};

}  // namespace fulcrum
