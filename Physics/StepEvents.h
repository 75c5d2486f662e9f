// What happened in a step, for games: contacts that began, went on and ended, hits of continuous collision, bodies that
// moved, woke and fell asleep, joints that broke. From PhysicsSystem::Events. Docs/Events.md.
#pragma once

#include <Fulcrum/Physics/JointSettings.h>

#include <array>
#include <span>

namespace fulcrum {

// Two pieces of bodies that touch: convex shapes, planes, meshes or height fields. They touch in a step in which they
// pressed against each other or that ends with them in contact; not where they are only near. They cease to where they
// are a quarter of SystemSettings::speculativeDistance apart, that of small shapes, and do not press.
struct ContactEvent {
    enum class Kind : uint8_t {
        Begin,  // they touch, and did not in the last step
        Stay,   // they did; what slept since then goes on with this one when it wakes
        End,    // they touch no longer: they came apart, or a body was removed, teleported, filtered out
        Hit,    // continuous collision stopped or deflected one of them in the middle of the step
    };
    struct Point {
        Position position = Position::Zero();  // m, in the middle between the two surfaces; as the step ended, of a Hit
                                               // at its time
        float separation = 0;                  // m, along the normal; negative where they overlap
        float impulse = 0;                     // N s along the normal, >= 0, of the whole step
    };
    // Points with one normal.
    struct Manifold {
        Vector3 normal = Vector3::Zero();           // unit, world, from A to B
        Vector3 frictionImpulse = Vector3::Zero();  // N s, world, on B, of the whole step; A got the opposite
        float twistImpulse = 0;                     // N m s about the normal, on B, likewise
        uint32_t triangle = 0;                      // where B is a mesh or a height field: of the deepest point
        uint32_t material = 0;                      // where B is one: what of its palette touches
        uint32_t pointCount = 0;                    // 1..4
        std::array<Point, 4> points{};              // the first pointCount of them; those that touch

        std::span<const Point> Points() const { return {points.data(), pointCount}; }
    };

    BodyId bodyA, bodyB;              // A is dynamic; of two dynamic bodies, that with the lower index
    uint32_t childA = 0, childB = 0;  // the pieces of compounds; else 0
    Kind kind = Kind::Begin;
    float time = 1;  // 0 .. 1, of the step; 1 but for a Hit
    // m/s, >= 0: the fastest that one of the points closed in along the normal before they met. It follows from the
    // velocities as the step began, those of a Hit at its time, and from gravity and forces until then.
    float approachSpeed = 0;
    std::span<const Manifold> manifolds;  // none of an End; several where B is a mesh or a height field

    // N s, of all points: how hard they pressed against each other in the step.
    float NormalImpulse() const;
    // N s, world, on B: all normals and friction; A got the opposite.
    Vector3 Impulse() const;
};

struct BrokenJoint {
    JointId id;
    Vector3 force = Vector3::Zero(), torque = Vector3::Zero();  // N, N m: means over the step, which were too much
};

// Arrays in an order that is the same for any number of threads. Valid until the next step; one of less than a
// nanosecond has none, and leaves what it would have to the next.
struct StepEvents {
    // With EventSettings::contacts. By A, B, children, kind, time.
    std::span<const ContactEvent> contacts;
    // With EventSettings::bodies, by id. What is awake as the step ended: dynamic bodies, and kinematic ones that move.
    std::span<const BodyId> awake;
    // Those whose pose is not that of the step before, or which are new; of what is awake or fell asleep in this step.
    std::span<const BodyId> moved;
    // Whose state is another than as the step before ended; new bodies are not among them.
    std::span<const BodyId> woke, fellAsleep;
    // Always, by id. They are disabled now.
    std::span<const BrokenJoint> brokenJoints;
};

}  // namespace fulcrum
