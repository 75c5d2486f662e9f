#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>

namespace fulcrum {

namespace {

std::string PathOf(size_t part) { return "parts[" + std::to_string(part) + "]"; }

// Checks the part's name and its place in the tree.
MaybeError CheckTree(const RagdollSettings& settings, size_t index) {
    const RagdollPart& part = settings.parts[index];
    if (part.name.empty()) return Error{ErrorCode::Degenerate, PathOf(index) + ".name is empty; a part needs one"};
    for (size_t other = 0; other < index; ++other)
        if (settings.parts[other].name == part.name)
            return Error{ErrorCode::Degenerate, PathOf(index) + ".name is \"" + part.name + "\", as that of " +
                                                    PathOf(other) + "; each part needs a name of its own"};
    const bool isValid = index == 0 ? part.parent == RagdollPart::kNoParent
                                    : part.parent >= 0 && static_cast<size_t>(part.parent) < index;
    if (isValid) return std::nullopt;
    return Error{ErrorCode::OutOfRange, PathOf(index) + ".parent is " + std::to_string(part.parent) + "; it must be " +
                                            (index == 0 ? "-1" : "from 0 to " + std::to_string(index - 1)) +
                                            " (part \"" + part.name + "\")"};
}

MaybeError Named(const RagdollSettings& settings, size_t part, const char* field, const MaybeError& error) {
    if (!error) return error;
    return Error{error->code,
                 PathOf(part) + "." + field + ": " + error->message + " (part \"" + settings.parts[part].name + "\")"};
}

Pose PoseOf(const RagdollPart& part) { return {part.body.position, Normalized(part.body.rotation)}; }

// An anchor as a frame, in the space in which it is given.
Pose FrameOf(const JointAnchor& anchor) { return {anchor.point, RotationOf(anchor)}; }

}  // namespace

const JointSettings& CommonOf(const RagdollJoint& joint) {
    return std::visit([](const auto& settings) -> const JointSettings& { return settings; }, joint);
}
JointSettings& CommonOf(RagdollJoint& joint) {
    return std::visit([](auto& settings) -> JointSettings& { return settings; }, joint);
}

MaybeError Check(const RagdollSettings& settings) {
    const DefaultFloats floats;
    if (settings.parts.empty()) return Error{ErrorCode::Degenerate, "parts is empty; a ragdoll needs one part or more"};
    for (size_t i = 0; i < settings.parts.size(); ++i) {
        const RagdollPart& part = settings.parts[i];
        if (MaybeError e = CheckTree(settings, i)) return e;
        if (MaybeError e = Named(settings, i, "body", Check(part.body))) return e;
        if (i == 0) continue;
        const MaybeError ofJoint = std::visit([](const auto& joint) { return Check(joint); }, part.joint);
        if (MaybeError e = Named(settings, i, "joint", ofJoint)) return e;
    }
    return std::nullopt;
}

RagdollJointFrames JointFramesOf(const RagdollSettings& settings, size_t part) {
    const DefaultFloats floats;
    const RagdollPart& child = settings.parts[part];
    const Pose childPose = PoseOf(child), parentPose = PoseOf(settings.parts[static_cast<size_t>(child.parent)]);
    const JointSettings& joint = CommonOf(child.joint);
    const bool isWorld = joint.space == JointSpace::World;
    // Both in the ragdoll's frame; anchors given in a body's frame are transformed to it and back.
    const auto inRagdoll = [&](const JointAnchor& anchor, const Pose& body) {
        const Pose frame = FrameOf(anchor);
        return isWorld ? frame : body * RelativePose{frame.position.cast<float>(), frame.rotation};
    };
    const Pose onParent = inRagdoll(joint.anchorA, parentPose);
    Pose onPart = onParent;
    if (joint.anchorB) {
        JointAnchor anchor = *joint.anchorB;
        if (!anchor.normal) {
            Vector3 normal = Rotate(onParent.rotation, Vector3(0, 1, 0));
            if (!isWorld) normal = InverseRotate(childPose.rotation, normal);
            SetNormalNear(anchor, normal);
        }
        onPart = inRagdoll(anchor, childPose);
    }
    RagdollJointFrames frames{Relative(parentPose, onParent), Relative(childPose, onPart)};
    frames.inParent.rotation = Normalized(frames.inParent.rotation);
    frames.inPart.rotation = Normalized(frames.inPart.rotation);
    return frames;
}

void ReferencePose(const RagdollSettings& settings, const Pose& origin, std::span<Pose> pose) {
    const DefaultFloats floats;
    FULCRUM_ASSERT(pose.size() == settings.parts.size());
    for (size_t i = 0; i < pose.size(); ++i) {
        const Pose own = PoseOf(settings.parts[i]);
        pose[i] = origin * RelativePose{own.position.cast<float>(), own.rotation};
        pose[i].rotation = Normalized(pose[i].rotation);
    }
}

void PoseFromJoints(const RagdollSettings& settings, const Pose& root, std::span<const Quaternion> jointRotations,
                    std::span<Pose> pose) {
    const DefaultFloats floats;
    FULCRUM_ASSERT(pose.size() == settings.parts.size() && jointRotations.size() == pose.size());
    pose[0] = root;
    for (size_t i = 1; i < pose.size(); ++i) {
        const RagdollJointFrames frames = JointFramesOf(settings, i);
        const Pose& parent = pose[static_cast<size_t>(settings.parts[i].parent)];
        pose[i] = parent * frames.inParent * RelativePose{Vector3::Zero(), jointRotations[i]} * Inverse(frames.inPart);
        pose[i].rotation = Normalized(pose[i].rotation);
    }
}

}  // namespace fulcrum
