// A recording's joints as columns of a page, in the varints of PageData.h. Called by PageData; Page/decodeJoints.js
// reads them.
// - joints: per joint: kind (index into the header's kinds), linear lock, angular lock, line, axis, flags (1 pyramid,
//   2 hard length, 4 closed path, 8 rotations, 16 translations, 32 steering, 64 rope, 128 path); track on A and on B
//   (1 + axis), circle about A and about B (1 + radius in kJointStep), each 0 for none; differences to the joint before
//   of body A, body B, ratio (in kJointRatioStep), and of frame A and frame B x y z (in kJointStep m), x y z w (in 1 /
//   kJointRotationSteps); number of points; per point the difference to the one before (in kJointStep)
// - jointStates: per frame: number of states; per state: gap to the joint before, flags (1 enabled, 2 other limits);
//   with flag 2: a bit for each finite end (2 axis + 0 for min, + 1 for max), and of these the differences to the
//   joint's last ones (in kJointStep m or rad)
// - jointErrors: per frame: distance and its joint, angle and its joint (in kJointErrorStep m or rad)
//
// All are empty if there are no joints.
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

#include <nlohmann/json.hpp>

#include <array>
#include <string>

namespace fulcrum {

inline constexpr double kJointStep = 1e-5;  // m or rad
inline constexpr double kJointRotationSteps = 1 << 20;
inline constexpr double kJointRatioStep = 1e-5;
inline constexpr double kJointErrorStep = 1e-6;  // m or rad

std::array<std::string, 3> JointColumns(const Recording& recording);

// Their number and the steps.
nlohmann::ordered_json JointHeader(const Recording& recording);

}  // namespace fulcrum
