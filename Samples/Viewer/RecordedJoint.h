// Joints of a recording: their frames in the bodies, their constant properties, and their state frame by frame. World
// poses follow from those of the bodies. Part of Recording.h; plain data.
#pragma once

#include <Fulcrum/Math/Pose.h>

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fulcrum {

// The degrees of freedom that the joint locks, in which errors are shown.
enum class RecordedLinearLock : uint8_t { None, Line, Point };
enum class RecordedAngularLock : uint8_t { None, Axis, All };

struct RecordedJoint {
    std::string kind = "custom";      // for people
    uint32_t bodyA = 0, bodyB = 0;    // indices into Recording::bodies
    RelativePose frameA{}, frameB{};  // of the joint, in each body's shape frame; x is the joint's axis
    RecordedLinearLock linearLock = RecordedLinearLock::None;
    RecordedAngularLock angularLock = RecordedAngularLock::None;
    uint8_t line = 0, axis = 0;  // that the locks Line and Axis leave free: 0, 1, 2 for x, y, z
    // What is drawn of the limits: of rotations, of translations, of the rotation about y of frame A about its x axis,
    // of the way along one axis of a frame.
    bool rotations = false, translations = false, steering = false;
    std::optional<int> trackA{}, trackB{};
    bool isPyramid = false;                                    // swing limits: a pyramid, else an ellipse
    float coneAngle = std::numeric_limits<float>::infinity();  // rad, of swing limits that are no axis' own
    std::optional<float> circleA{}, circleB{};  // m, about the frames' x axes; 0: as large as the joint is drawn
    bool isRope = false, isPath = false;        // whether it is a rope from A to B, a curve for B to ride on
    bool isHardLength = false;                  // rope: beyond its range is an error
    float ratio = 1;                            // rope: how many times B's side counts
    // Path: the curve, in frame A, m. Rope: points on its way, m, relative to Recording::origin.
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
    std::array<RecordedRange, 6> limits{};  // way along x y z, rotation about x y z of frame A
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
