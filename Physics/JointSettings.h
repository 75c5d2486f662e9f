// Settings shared by all joints: bodies, anchors, strength. Settings of each kind are in the kind's file in Joints/.
// Every field states its unit and range.
#pragma once

#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Physics/Settings.h>

#include <limits>
#include <optional>

namespace fulcrum {

// Identifies a joint. Ids of removed joints are never valid again.
struct JointId {
    uint32_t index = 0xFFFFFFFFu;
    uint32_t generation = 0;
    friend auto operator<=>(const JointId&, const JointId&) = default;
};

// The world as a body of joints, which never moves: for JointSettings and JointInterface. Other calls do not know this
// id.
inline constexpr BodyId kWorldBody = {0xFFFFFFFFu, 0xFFFFFFFFu};

enum class JointSpace : uint8_t {
    World,  // points and axes are in world space, at the bodies' current poses
    Body,   // points and axes are in each body's own frame
};

// Attachment of a joint to a body: the anchor point and the joint's frame, whose x axis is the joint's axis (hinge,
// slider, twist).
struct JointAnchor {
    Position point = Position::Zero();  // m
    Vector3 axis = Vector3(1, 0, 0);    // x of the frame; unit within 1e-3
    std::optional<Vector3> normal{};    // y of the frame; unit, perpendicular to the axis within 1e-3; left out: any
};

// Of two joints of a body the one of higher priority is solved later in every iteration, and wins in a conflict. A
// joint to a static or kinematic body is solved as late. This is an order, not a weight: with few iterations the joint
// of lower priority still has an effect.
enum class JointPriority : uint8_t { Normal, High };

struct JointSettings {
    BodyId bodyA{}, bodyB{};  // at least one is dynamic; kWorldBody: the world, whose body frame is world space
    JointSpace space = JointSpace::World;
    JointAnchor anchorA;
    std::optional<JointAnchor> anchorB{};  // left out: coincides with anchor A at the current poses
    bool enabled = true;
    bool collideConnected = false;  // whether the two bodies collide with each other
    JointPriority priority = JointPriority::Normal;
    // The joint breaks (is disabled) if its average force or torque over a step exceeds one of these; an impulse of J N
    // s counts as J / dt.
    float breakForce = std::numeric_limits<float>::infinity();   // N, > 0
    float breakTorque = std::numeric_limits<float>::infinity();  // N m, > 0
    // Minimum solver effort for this joint's island; 0: the system's.
    int substeps = 0;            // 0..64
    int velocityIterations = 0;  // 0..255
    int positionIterations = 0;  // 0..255
    // m, >= 0, in place of AccuracyTarget::jointError: how far apart its anchors may be before its mechanism is solved
    // directly; 0: as that, infinite: anyhow.
    float errorTarget = 0;
    // Mass scales of the two bodies in this joint. Mechanisms with such a joint are not solved directly.
    MassOverride massOverride{};
    uint64_t userData = 0;
};

}  // namespace fulcrum
