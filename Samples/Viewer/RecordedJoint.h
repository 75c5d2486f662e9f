// Joints of a recording: their frames in the bodies, their constant properties, and their state frame by frame. World
// poses follow from those of the bodies. Part of Recording.h; plain data.
#pragma once

#include <Fulcrum/Math/Pose.h>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace fulcrum {

// In the order of the page's names for them.
enum class RecordedJointKind : uint8_t {
    Point,
    Fixed,
    Distance,
    Hinge,
    Slider,
    Cone,
    SwingTwist,
    SixDof,
    Gear,
    RackAndPinion,
    Pulley,
    Path,
    Wheel,
    Custom
};
inline constexpr size_t kRecordedJointKinds = 14;

// The degrees of freedom that the joint locks, in which errors are shown.
enum class RecordedLinearLock : uint8_t { None, Line, Point };
enum class RecordedAngularLock : uint8_t { None, Axis, All };

struct RecordedJoint {
    RecordedJointKind kind = RecordedJointKind::Point;
    uint32_t bodyA = 0, bodyB = 0;    // indices into Recording::bodies
    RelativePose frameA{}, frameB{};  // of the joint, in each body's shape frame; x is the joint's axis
    RecordedLinearLock linearLock = RecordedLinearLock::None;
    RecordedAngularLock angularLock = RecordedAngularLock::None;
    uint8_t line = 0, axis = 0;  // that the locks Line and Axis leave free: 0, 1, 2 for x, y, z
    bool isPyramid = false;      // swing limits: a pyramid, else an ellipse
    bool isHardLength = false;   // distance, pulley: beyond its range is an error
    float ratio = 1;             // gear, rack and pinion, pulley
    // Path: the curve, in frame A, m. Pulley: its two fixed points, m, relative to Recording::origin.
    std::vector<Vector3> points{};
    bool isClosed = false;  // path
};

// Limits of an axis, m or rad; an end that is infinite is none.
struct RecordedRange {
    float min = -std::numeric_limits<float>::infinity();
    float max = std::numeric_limits<float>::infinity();
    friend bool operator==(const RecordedRange&, const RecordedRange&) = default;
};

struct RecordedJointState {
    uint32_t joint = 0;                     // index into Recording::joints
    bool enabled = true;                    // false: switched off, broken or removed
    std::array<RecordedRange, 6> limits{};  // way along x y z, rotation about x y z of frame A; of a cone: about y
    friend bool operator==(const RecordedJointState&, const RecordedJointState&) = default;
};

// The largest errors of a frame's joints, and their joints.
struct RecordedJointErrors {
    float distance = 0, angle = 0;               // m, rad
    uint32_t distanceJoint = 0, angleJoint = 0;  // indices into Recording::joints
};

struct RecordedFrameJoints {
    std::span<const RecordedJointState> states;  // ascending by joint
    RecordedJointErrors errors;
};

}  // namespace fulcrum
