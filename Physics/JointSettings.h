// What a user sets of a joint: the bodies, where it holds them, and what its kind needs. Every field says its unit and range.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/Settings.h>

#include <limits>
#include <optional>

namespace fulcrum {

// Names a joint. Ids of removed joints are never valid again.
struct JointId {
    uint32_t index = 0xFFFFFFFFu;
    uint32_t generation = 0;
    friend auto operator<=>(const JointId&, const JointId&) = default;
};

enum class JointSpace : uint8_t {
    World,  // places and axes are those of the world, as the bodies stand now
    Body,   // places and axes are those of each body's own frame
};

// Where a joint holds a body: a place and a frame, whose x axis is the joint's axis (hinge, slide, twist).
struct JointAnchor {
    Position point = Position::Zero();      // m
    Vector3 axis = Vector3(1, 0, 0);        // x of the frame; unit within 1e-3
    std::optional<Vector3> normal;          // y of the frame; unit, perpendicular to the axis within 1e-3; left out: any
};

// Of two joints of a body the one of higher priority is solved later, and wins where they disagree.
enum class JointPriority : uint8_t { Normal, High };

struct JointSettings {
    BodyId bodyA, bodyB;              // at least one is dynamic
    JointSpace space = JointSpace::World;
    JointAnchor anchorA;
    std::optional<JointAnchor> anchorB;  // left out: where anchor A is in the world, as the bodies stand now
    bool enabled = true;
    bool collideConnected = false;    // whether the two bodies collide with each other
    JointPriority priority = JointPriority::Normal;
    float breakForce = std::numeric_limits<float>::infinity();   // N, > 0: the joint is disabled beyond it
    float breakTorque = std::numeric_limits<float>::infinity();  // N m, > 0
    // More effort for the island of this joint alone; 0: the system's.
    int substeps = 0;            // 0..64
    int velocityIterations = 0;  // 0..255
    int positionIterations = 0;  // 0..255
    uint64_t userData = 0;
};

// B's anchor stays at A's; B turns freely.
struct PointJointSettings : JointSettings {};

// B does not move against A.
struct FixedJointSettings : JointSettings {};

// The distance of the anchors stays in a range: a rod, a rope, a spring.
struct DistanceJointSettings : JointSettings {
    // m, 0 <= min <= max, max may be infinite. One left out: 0, infinite. Both left out: as it is when the joint is made.
    std::optional<float> minDistance, maxDistance;
    SpringSettings spring;  // of both ends; where min is max, of the distance itself
};

// B turns about the anchor's axis. The angle is the rotation of B against A about it, zero where the frames coincide,
// counted over any number of turns.
struct HingeJointSettings : JointSettings {
    AxisControl angle;  // rad, rad/s, N m
};

// B slides along the anchor's axis and does not turn.
struct SliderJointSettings : JointSettings {
    AxisControl slide;  // m, m/s, N
};

}  // namespace fulcrum
