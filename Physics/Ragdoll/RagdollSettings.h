// A ragdoll as data: rigid parts in a tree, and the joint of each to its parent. Written down or read from a file once,
// created as often as wanted (Ragdoll.h). Plain data and free functions, any thread.
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

// What all kinds share.
const JointSettings& CommonOf(const RagdollJoint& joint);
JointSettings& CommonOf(RagdollJoint& joint);

struct RagdollPart {
    static constexpr int kNoParent = -1;

    std::string name;        // not empty, another than all others'
    int parent = kNoParent;  // of the first part; else the index of a part before this one
    // Pose and velocities are those in the reference pose and in the ragdoll's own frame, whose origin is anywhere.
    BodySettings body;
    // To the parent, which is its body A, while the part is its body B: bodyA and bodyB are not read. Places and axes
    // in JointSpace::World are those of the ragdoll's frame in the reference pose. The first part's is not read.
    RagdollJoint joint;
};

struct RagdollSettings {
    std::vector<RagdollPart> parts;
};

// Error: that of the first field that is wrong, named with its part, such as
// `parts[2].joint: twist.friction is -1; it must be 0 or more (part "head")`.
MaybeError Check(const RagdollSettings& settings);

// The frame of a part's joint in the parent's own frame and in the part's own; its x axis is the joint's axis.
struct RagdollJointFrames {
    RelativePose inParent, inPart;
};
// Settings must be valid, `part` not the first.
RagdollJointFrames JointFramesOf(const RagdollSettings& settings, size_t part);

// The pose of each part with the ragdoll's frame at `origin`. `pose` has one element a part.
void ReferencePose(const RagdollSettings& settings, const Pose& origin, std::span<Pose> pose);

// The pose of each part that has its first part at `root` and in which each joint's frame on the part is turned by
// jointRotations[part], unit, against that on the parent, their anchors together: what position motors are told.
// Identity is where all angles are zero. Both spans have one element a part; jointRotations[0] is not read.
void PoseFromJoints(const RagdollSettings& settings, const Pose& root, std::span<const Quaternion> jointRotations,
                    std::span<Pose> pose);

}  // namespace fulcrum
