// Where the anchors of joints are, and how far joints are from what their locks and hard rows ask for. Between steps;
// free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Joints/JointError.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// In the world, of an existing joint at the poses of its bodies: the frame of its anchor of A (side 0) or B (1), and
// both, with zero velocities.
Pose AnchorFrameOf(const WorldState& world, uint32_t index, int side);
JointPose PoseOf(const WorldState& world, uint32_t index);
// Of an existing joint at the poses of its bodies.
JointError ErrorOfJoint(const WorldState& world, uint32_t index);
// Likewise, with the way by which springs and soft limits are stretched.
JointError StretchOfJoint(const WorldState& world, uint32_t index);

}  // namespace fulcrum
