// What a user sets of a joint: the bodies, where it holds them, and what its kind needs. Every field says its unit and
// range.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Constraints/Joints/PathJoint.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Constraints/Parts/SwingTwist.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/Settings.h>

#include <limits>
#include <memory>
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
    Position point = Position::Zero();  // m
    Vector3 axis = Vector3(1, 0, 0);    // x of the frame; unit within 1e-3
    std::optional<Vector3> normal{};    // y of the frame; unit, perpendicular to the axis within 1e-3; left out: any
};

// Of two joints of a body the one of higher priority is solved later in every iteration, and wins where they disagree.
// A joint to a static or kinematic body counts as High. This is an order, no weight: where few iterations are made the
// other one still pulls.
enum class JointPriority : uint8_t { Normal, High };

struct JointSettings {
    BodyId bodyA{}, bodyB{};  // at least one is dynamic
    JointSpace space = JointSpace::World;
    JointAnchor anchorA;
    std::optional<JointAnchor> anchorB{};  // left out: where anchor A is in the world, as the bodies stand now
    bool enabled = true;
    bool collideConnected = false;  // whether the two bodies collide with each other
    JointPriority priority = JointPriority::Normal;
    // The joint is disabled where it did more on average over a step: an impulse of J N s counts as J / dt.
    float breakForce = std::numeric_limits<float>::infinity();   // N, > 0
    float breakTorque = std::numeric_limits<float>::infinity();  // N m, > 0
    // More effort for the island of this joint alone; 0: the system's.
    int substeps = 0;            // 0..64
    int velocityIterations = 0;  // 0..255
    int positionIterations = 0;  // 0..255
    // For this joint the bodies are so much lighter or heavier. What hangs together by it is not solved as a tree.
    MassOverride massOverride{};
    uint64_t userData = 0;
};

// B's anchor stays at A's; B turns freely.
struct PointJointSettings : JointSettings {};

// B does not move against A.
struct FixedJointSettings : JointSettings {};

// The distance of the anchors stays in a range: a rod, a rope, a spring.
struct DistanceJointSettings : JointSettings {
    // m, 0 <= min <= max, max may be infinite. One left out: 0, infinite. Both left out: as it is when the joint is
    // made.
    std::optional<float> minDistance{}, maxDistance{};
    SpringSettings spring{};  // of both ends; where min is max, of the distance itself
};

// B turns about the anchor's axis. The angle is the rotation of B against A about it, zero where the frames coincide,
// counted over any number of turns as long as it has limits, a motor or friction.
struct HingeJointSettings : JointSettings {
    AxisControl angle{};  // rad, rad/s, N m
};

// B slides along the anchor's axis and does not turn.
struct SliderJointSettings : JointSettings {
    AxisControl slide{};  // m, m/s, N
};

// A point joint whose axes stay within an angle of each other; B spins about its axis freely.
struct ConeJointSettings : JointSettings {
    float halfAngle = 0.785398163f;  // rad, 0..pi; pi: no limit
    SpringSettings spring{};         // of the limit
};

// A point joint for shoulders: B's axis (x) swings about A's y and z in an ellipse or a pyramid, and B twists about it.
struct SwingTwistJointSettings : JointSettings {
    SwingShape shape = SwingShape::Ellipse;
    // rad, N m. Limits within -pi..pi, at pi there is none. Those of the swing, the y and z of its rotation vector, are
    // around 0, and for an ellipse the same to both sides: -a..a, -b..b.
    AxisControl twist{}, swingY{}, swingZ{};
};

// What `limited` alone means: locked at zero.
inline constexpr AxisControl kLockedAxis = {.limited = true};

// Each axis free, limited or locked (kLockedAxis; hard or, with a spring on its limits, soft), with motor and friction.
struct SixDofJointSettings : JointSettings {
    // In the order of JointAxis: m and N; rad and N m, rotations as in SwingTwistJointSettings.
    std::array<AxisControl, 6> axes{};
    SwingShape shape = SwingShape::Pyramid;

    // Ends the program where there is no such axis.
    AxisControl& operator[](JointAxis axis) {
        if (axis > JointAxis::AngularZ) [[unlikely]]
            AbortWith("SixDofJointSettings has no axis of this number", "");
        return axes[static_cast<size_t>(axis)];
    }
};

// A turns about anchor A's axis, B about anchor B's, each in a bearing that other joints make to a body at rest; their
// teeth mesh. turns of A = -ratio turns of B.
struct GearJointSettings : JointSettings {
    float ratio = 1.0f;  // 1e-9..1e9 without its sign; teeth of B / teeth of A, > 0 where they mesh outside
};

// A, the pinion, turns about anchor A's axis through its point; B, the rack, moves along anchor B's axis. Other joints
// make bearing and guide.
struct RackAndPinionJointSettings : JointSettings {
    float ratio = 1.0f;  // rad/m, 1e-9..1e9 without its sign; 1 / radius of the pinion, negative to move the other way
};

// A rope from A's anchor over two fixed points to B's: distance of A + ratio distance of B = its length.
struct PulleyJointSettings : JointSettings {
    Position fixedPointA = Position::Zero();  // m, world space
    Position fixedPointB = Position::Zero();  // m, world space
    float ratio = 1.0f;                       // 1e-9..1e9
    float minLength = 0.0f;                   // m, >= 0
    std::optional<float> maxLength{};         // m, >= minLength; left out: as it is when the joint is made
};

// B's anchor rides on a path that is given in the frame of A's anchor. Where B is to turn with the path, its frame
// becomes the path's: x along the tangent, y along the normal. So give anchor B: where B is tied, and which of its axes
// these are.
struct PathJointSettings : JointSettings {
    std::shared_ptr<const Path> path = Path::Straight(1.0f);  // not null
    AxisControl along{};                                      // m from its start, m/s, N
    PathRotation rotation = PathRotation::Free;
};

// B, a wheel, spins about the anchor's axis, its axle, and slides along the anchor's normal, upwards, which steers too.
struct WheelJointSettings : JointSettings {
    WheelJointSettings() { anchorA.normal = Vector3(0, 1, 0); }

    // m, N; zero where the anchors coincide. The motor's spring carries the chassis, the limits are the stops.
    AxisControl suspension = {
        .limited = true,
        .limits = {.min = -0.2f, .max = 0.2f},
        .motor = {.mode = MotorMode::ToPosition,
                  .spring = {.mode = SpringMode::StiffnessAndDamping, .stiffness = 4.0e4f, .damping = 4.0e3f}}};
    bool isSteered = false;
    // rad, N m; used where steered.
    AxisControl steering = {
        .limited = true, .limits = {.min = -0.6f, .max = 0.6f}, .motor = {.mode = MotorMode::ToPosition, .spring = {}}};
    AxisControl spin{};  // rad, N m; the motor drives, friction brakes
};

// A constraint of the user's own.
struct CustomJointSettings : JointSettings {
    Function<std::unique_ptr<JointType>()> make;  // not empty; called once a joint, gives a type
};

// Calls a macro with the name of every kind above, without JointSettings.
#define FULCRUM_FOR_EACH_JOINT_KIND(call)                                                                    \
    call(Point) call(Fixed) call(Distance) call(Hinge) call(Slider) call(Cone) call(SwingTwist) call(SixDof) \
        call(Gear) call(RackAndPinion) call(Pulley) call(Path) call(Wheel) call(Custom)

}  // namespace fulcrum
