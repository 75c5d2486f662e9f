// Maps poses of a detailed animation skeleton to the few parts of a ragdoll, and back. Created once from both in their
// reference poses, used every frame; immutable, so any number of threads may use one.
//
// A mapped joint and its part are rigidly connected as in the reference pose, so both directions are exact. Other
// joints are placed as follows:
// - Joints between two mapped ones are a chain, e.g. a spine of many joints over a torso of one part. The chain is
//   rotated about its start so that its end points to its position on the ragdoll; then it is stretched and twisted
//   evenly to close the remaining gap. A chain whose local poses already reach its end keeps them, and so the detail of
//   the animation.
// - Joints that lead to several mapped ones belong to the chain of the one that was paired first.
// - All others keep their local pose: fingers, hair, a root above the first mapped joint.
#pragma once

#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

#include <utility>

namespace fulcrum {

struct SkeletonJoint {
    static constexpr int kNoParent = -1;

    std::string name;
    int parent = kNoParent;  // or the index of a joint before this one
    RelativePose reference;  // in the parent's frame, or the ragdoll's if there is no parent; reference pose
};

struct Skeleton {
    std::vector<SkeletonJoint> joints;
};

// The names of a joint and of the part to which it is mapped.
struct SkeletonPair {
    std::string joint, part;
};

// A pair for every joint with the name of a part.
std::vector<SkeletonPair> PairsByName(const Skeleton& skeleton, const RagdollSettings& ragdoll);

class SkeletonMapping {
public:
    // Errors: those of Check; OutOfRange (a parent), NonFinite, Unnormalized (a reference pose), Unsupported (a pair
    // whose names are unknown or not unique, a joint or part in two pairs, a first part in none); the message names the
    // joint or part. The arguments need not outlive the mapping.
    static Result<SkeletonMapping> Create(const Skeleton& skeleton, const RagdollSettings& ragdoll,
                                          std::span<const SkeletonPair> pairs);

    size_t JointCount() const { return joints_.size(); }
    size_t PartCount() const { return parts_.size(); }
    // Local poses of the skeleton in its reference pose, one per joint.
    std::span<const RelativePose> ReferenceLocals() const;

    // World poses of the joints from their local poses; joints without a parent are relative to `origin`. One element
    // per joint.
    void PoseJoints(const Pose& origin, std::span<const RelativePose> locals, std::span<Pose> joints) const;
    // World poses of the parts, one per part, from those of the joints. A part without a pair follows its parent as in
    // the reference pose.
    void ToRagdoll(std::span<const Pose> joints, std::span<Pose> parts) const;
    // The inverse, as explained above. `locals`: on input the local poses of joints that the ragdoll does not determine
    // (the animation's or ReferenceLocals), on output those of all joints. `joints`: returns the world poses.
    void ToSkeleton(const Pose& origin, std::span<const Pose> parts, std::span<RelativePose> locals,
                    std::span<Pose> joints) const;

private:
    static constexpr int kNone = -1;

    struct Joint {
        int parent = kNone;
        int part = kNone;     // mapped
        RelativePose inPart;  // for mapped joints, in the part's frame
    };
    struct Part {
        int joint = kNone;     // mapped
        RelativePose inJoint;  // in that joint's frame, or in the parent part's if there is none
        int parent = kNone;
    };
    // Joints from below `start` down to the one above `end`; start is mapped or in an earlier chain, end is mapped.
    struct Chain {
        int start = kNone, end = kNone;
        std::vector<int> joints;
        std::vector<float> fractions;  // position of each joint along the chain, 0..1
    };

    void AddChain(const Skeleton& skeleton, int end, std::vector<bool>& isPlaced);
    void PlaceChain(const Chain& chain, std::span<const RelativePose> locals, std::span<Pose> joints) const;

    std::vector<Joint> joints_;
    std::vector<Part> parts_;
    std::vector<Chain> chains_;
    std::vector<bool> isInChain_;  // one per joint
    std::vector<RelativePose> references_;
};

}  // namespace fulcrum
