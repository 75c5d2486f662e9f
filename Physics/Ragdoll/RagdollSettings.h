// Description of a ragdoll: a tree of rigid parts, each with a joint to its parent. Ragdolls are created from it any
// number of times (Ragdoll.h). Plain data and free functions, any thread.
#pragma once

#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/Validation.h>

#include <span>
#include <string>
#include <variant>
#include <vector>

namespace fulcrum {

// The kinds of joints that hold a body together.
using RagdollJoint = std::variant<PointJointSettings, FixedJointSettings, HingeJointSettings, ConeJointSettings,
                                  SwingTwistJointSettings, SixDofJointSettings>;

// The settings shared by all kinds.
const JointSettings& CommonOf(const RagdollJoint& joint);
JointSettings& CommonOf(RagdollJoint& joint);

struct RagdollPart {
    static constexpr int kNoParent = -1;

    std::string name;        // not empty, unique
    int parent = kNoParent;  // for the first part; else the index of an earlier part
    // Pose and velocities are those of the reference pose, in the ragdoll's own frame, whose origin may be anywhere.
    BodySettings body;
    // Joint to the parent, which is its body A; the part is its body B. bodyA and bodyB are ignored. Points and axes in
    // JointSpace::World are in the ragdoll's frame, in the reference pose. Ignored for the first part.
    RagdollJoint joint;
};

struct RagdollSettings {
    std::vector<RagdollPart> parts;
};

// Error: that of the first invalid field, named with its part, such as
// `parts[2].joint: twist.friction is -1; it must be 0 or more (part "head")`.
MaybeError Check(const RagdollSettings& settings);

// The frame of a part's joint, in the parent's own frame and in the part's own frame; its x axis is the joint's axis.
struct RagdollJointFrames {
    RelativePose inParent, inPart;
};
// Settings must be valid, `part` not the first.
RagdollJointFrames JointFramesOf(const RagdollSettings& settings, size_t part);

// The pose of each part with the ragdoll's frame at `origin`. `pose` has one element per part.
void ReferencePose(const RagdollSettings& settings, const Pose& origin, std::span<Pose> pose);

// Forward kinematics: the pose of each part with the first part at `root`, each joint's frame on the part rotated by
// jointRotations[part], unit, relative to that on the parent, and anchors coinciding: the targets of position motors.
// Identity means that all angles are zero. Both spans have one element per part; jointRotations[0] is ignored.
void PoseFromJoints(const RagdollSettings& settings, const Pose& root, std::span<const Quaternion> jointRotations,
                    std::span<Pose> pose);

}  // namespace fulcrum
