// Takes poses of a detailed animation skeleton to the few parts of a ragdoll, and back. Made once from both in their
// reference poses, used every frame; immutable, so any number of threads may use one.
//
// A mapped joint and its part are rigidly connected as they are in the reference pose; so both ways are exact. Other
// joints are placed as follows:
// - Joints between two mapped ones are a chain, e.g. a spine of many joints over a torso of one part. The chain is
//   rotated about its start so that its end points to where the ragdoll has it; then it is stretched and twisted evenly
//   to close the gap that remains. A chain whose local poses reach its end already keeps them, and so the detail of the
//   animation.
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
    RelativePose reference;  // in the parent's frame; without a parent in the ragdoll's frame, in the reference pose
};

struct Skeleton {
    std::vector<SkeletonJoint> joints;
};

// The names of a joint and of the part that it moves with.
struct SkeletonPair {
    std::string joint, part;
};

// A pair for every joint that has the name of a part.
std::vector<SkeletonPair> PairsByName(const Skeleton& skeleton, const RagdollSettings& ragdoll);

class SkeletonMapping {
public:
    // Errors: those of Check; OutOfRange (a parent), NonFinite, Unnormalized (a reference pose), Unsupported (a pair
    // whose names are unknown or not unique, a joint or part in two pairs, a first part in none); the message names the
    // joint or part. Nothing of the arguments is kept but numbers.
    static Result<SkeletonMapping> Create(const Skeleton& skeleton, const RagdollSettings& ragdoll,
                                          std::span<const SkeletonPair> pairs);

    size_t JointCount() const { return joints_.size(); }
    size_t PartCount() const { return parts_.size(); }
    // Of the skeleton in its reference pose, one a joint.
    std::span<const RelativePose> ReferenceLocals() const;

    // World poses of the joints, by their local poses; joints without a parent are in the frame `origin`. One element a
    // joint.
    void PoseJoints(const Pose& origin, std::span<const RelativePose> locals, std::span<Pose> joints) const;
    // World poses of the parts, one each, by those of the joints. A part that is in no pair follows its parent as in
    // the reference pose.
    void ToRagdoll(std::span<const Pose> joints, std::span<Pose> parts) const;
    // The way back, as said above. `locals` comes in with what joints that the ragdoll does not decide have, the
    // animation's or ReferenceLocals, and goes out with the local pose of every joint; `joints` with the world poses.
    void ToSkeleton(const Pose& origin, std::span<const Pose> parts, std::span<RelativePose> locals,
                    std::span<Pose> joints) const;

private:
    static constexpr int kNone = -1;

    struct Joint {
        int parent = kNone;
        int part = kNone;     // mapped
        RelativePose inPart;  // of a mapped joint, in the part's frame
    };
    struct Part {
        int joint = kNone;     // mapped
        RelativePose inJoint;  // in that joint's frame, or, where there is none, in the parent part's
        int parent = kNone;
    };
    // Joints from below `start` down to the one above `end`; start is mapped or in an earlier chain, end is mapped.
    struct Chain {
        int start = kNone, end = kNone;
        std::vector<int> joints;
        std::vector<float> fractions;  // of the way from start to end, of each joint, 0..1
    };

    void AddChain(const Skeleton& skeleton, int end, std::vector<bool>& isPlaced);
    void PlaceChain(const Chain& chain, std::span<const RelativePose> locals, std::span<Pose> joints) const;

    std::vector<Joint> joints_;
    std::vector<Part> parts_;
    std::vector<Chain> chains_;
    std::vector<bool> isInChain_;  // one a joint
    std::vector<RelativePose> references_;
};

}  // namespace fulcrum
