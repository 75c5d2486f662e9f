#include <Fulcrum/Physics/Ragdoll/SkeletonMapping.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>

namespace fulcrum {

namespace {

MaybeError CheckSkeleton(const Skeleton& skeleton) {
    for (size_t i = 0; i < skeleton.joints.size(); ++i) {
        const SkeletonJoint& joint = skeleton.joints[i];
        const std::string name = "joints[" + std::to_string(i) + "]";
        if (joint.parent != SkeletonJoint::kNoParent && (joint.parent < 0 || static_cast<size_t>(joint.parent) >= i))
            return Error{ErrorCode::OutOfRange, name + ".parent is " + std::to_string(joint.parent) +
                                                    "; it must be -1 or the index of a joint before (joint \"" +
                                                    joint.name + "\")"};
        const MaybeError e = FirstOf(CheckFinite("reference.position", joint.reference.position),
                                     CheckRotation("reference.rotation", joint.reference.rotation));
        if (e) return Error{e->code, name + "." + e->message + " (joint \"" + joint.name + "\")"};
    }
    return std::nullopt;
}

// The index of the element with the name; an error if there is none or more than one.
template <class Elements>
Result<int> Find(const Elements& elements, const std::string& name, const char* what) {
    const auto hasName = [&](const auto& element) { return element.name == name; };
    const auto first = std::find_if(elements.begin(), elements.end(), hasName);
    if (first == elements.end())
        return Error{ErrorCode::Unsupported, std::string("no ") + what + " has the name \"" + name + "\""};
    if (std::find_if(first + 1, elements.end(), hasName) != elements.end())
        return Error{ErrorCode::Unsupported, std::string("more than one ") + what + " has the name \"" + name + "\""};
    return static_cast<int>(first - elements.begin());
}

RelativePose Normal(const RelativePose& pose) { return {pose.position, Normalized(pose.rotation)}; }

// The shortest rotation that takes the direction of a to that of b; identity if one of them has zero length.
Quaternion TurnBetween(const Vector3& a, const Vector3& b) {
    const float lengths = Length(a) * Length(b);
    if (!(lengths > 1e-12f)) return {};
    const Vector3 cross = Cross<float>(a, b);
    const float w = lengths + Dot(a, b);
    // Opposite: half a revolution about any perpendicular axis.
    if (w < 1e-6f * lengths) {
        const Vector3 axis = Perpendicular(Normalized(a));
        return {axis.x(), axis.y(), axis.z(), 0.0f};
    }
    return Normalized(Quaternion{cross.x(), cross.y(), cross.z(), w});
}

}  // namespace

std::vector<SkeletonPair> PairsByName(const Skeleton& skeleton, const RagdollSettings& ragdoll) {
    std::vector<SkeletonPair> pairs;
    for (const RagdollPart& part : ragdoll.parts)
        for (const SkeletonJoint& joint : skeleton.joints)
            if (joint.name == part.name) pairs.push_back({joint.name, part.name});
    return pairs;
}

Result<SkeletonMapping> SkeletonMapping::Create(const Skeleton& skeleton, const RagdollSettings& ragdoll,
                                                std::span<const SkeletonPair> pairs) {
    const DefaultFloats floats;
    if (MaybeError e = FirstOf(Check(ragdoll), CheckSkeleton(skeleton))) return *e;
    SkeletonMapping mapping;
    for (const SkeletonJoint& joint : skeleton.joints) {
        mapping.joints_.push_back({.parent = joint.parent, .inPart = {}});
        mapping.references_.push_back(Normal(joint.reference));
    }
    std::vector<Pose> joints(skeleton.joints.size()), parts(ragdoll.parts.size());
    mapping.PoseJoints({}, mapping.references_, joints);
    ReferencePose(ragdoll, {}, parts);

    mapping.parts_.resize(parts.size());
    for (const SkeletonPair& pair : pairs) {
        const Result<int> joint = Find(skeleton.joints, pair.joint, "joint"),
                          part = Find(ragdoll.parts, pair.part, "part");
        if (!joint) return joint.GetError();
        if (!part) return part.GetError();
        const auto j = static_cast<size_t>(joint.Value()), p = static_cast<size_t>(part.Value());
        if (mapping.joints_[j].part != kNone)
            return Error{ErrorCode::Unsupported, "the joint \"" + pair.joint + "\" is in two pairs"};
        if (mapping.parts_[p].joint != kNone)
            return Error{ErrorCode::Unsupported, "the part \"" + pair.part + "\" is in two pairs"};
        mapping.joints_[j].part = part.Value();
        mapping.joints_[j].inPart = Normal(Relative(parts[p], joints[j]));
        mapping.parts_[p].joint = joint.Value();
        mapping.parts_[p].inJoint = Normal(Relative(joints[j], parts[p]));
    }
    if (mapping.parts_[0].joint == kNone)
        return Error{ErrorCode::Unsupported,
                     "the part \"" + ragdoll.parts[0].name + "\" is in no pair; the first part must be"};
    for (size_t p = 1; p < parts.size(); ++p) {
        Part& part = mapping.parts_[p];
        part.parent = ragdoll.parts[p].parent;
        if (part.joint == kNone) part.inJoint = Normal(Relative(parts[static_cast<size_t>(part.parent)], parts[p]));
    }

    std::vector<bool> isPlaced(joints.size());
    for (size_t j = 0; j < joints.size(); ++j) isPlaced[j] = mapping.joints_[j].part != kNone;
    mapping.isInChain_.assign(joints.size(), false);
    for (const SkeletonPair& pair : pairs)
        mapping.AddChain(skeleton, Find(skeleton.joints, pair.joint, "joint").Value(), isPlaced);
    return mapping;
}

// The chain of joints between `end` and its nearest ancestor that is already placed, if any.
std::span<const RelativePose> SkeletonMapping::ReferenceLocals() const { return references_; }

void SkeletonMapping::AddChain(const Skeleton& skeleton, int end, std::vector<bool>& isPlaced) {
    Chain chain{.start = joints_[static_cast<size_t>(end)].parent, .end = end, .joints = {}, .fractions = {}};
    while (chain.start != kNone && !isPlaced[static_cast<size_t>(chain.start)]) {
        chain.joints.push_back(chain.start);
        chain.start = joints_[static_cast<size_t>(chain.start)].parent;
    }
    if (chain.start == kNone || chain.joints.empty()) return;
    std::reverse(chain.joints.begin(), chain.joints.end());
    const auto lengthOf = [&](int joint) {
        return Length(skeleton.joints[static_cast<size_t>(joint)].reference.position);
    };
    float way = 0;
    for (int joint : chain.joints) {
        isPlaced[static_cast<size_t>(joint)] = isInChain_[static_cast<size_t>(joint)] = true;
        way += lengthOf(joint);
        chain.fractions.push_back(way);
    }
    way += lengthOf(end);
    // Coincident joints share evenly.
    for (size_t i = 0; i < chain.joints.size(); ++i)
        chain.fractions[i] = way > 1e-6f ? chain.fractions[i] / way
                                         : static_cast<float>(i + 1) / static_cast<float>(chain.joints.size() + 1);
    chains_.push_back(std::move(chain));
}

void SkeletonMapping::PoseJoints(const Pose& origin, std::span<const RelativePose> locals,
                                 std::span<Pose> joints) const {
    const DefaultFloats floats;
    FULCRUM_ASSERT(locals.size() == joints_.size() && joints.size() == joints_.size());
    for (size_t j = 0; j < joints_.size(); ++j) {
        const int parent = joints_[j].parent;
        joints[j] = (parent == kNone ? origin : joints[static_cast<size_t>(parent)]) * locals[j];
        joints[j].rotation = Normalized(joints[j].rotation);
    }
}

void SkeletonMapping::ToRagdoll(std::span<const Pose> joints, std::span<Pose> parts) const {
    const DefaultFloats floats;
    FULCRUM_ASSERT(joints.size() == joints_.size() && parts.size() == parts_.size());
    for (size_t p = 0; p < parts_.size(); ++p) {
        const Part& part = parts_[p];
        parts[p] =
            (part.joint != kNone ? joints[static_cast<size_t>(part.joint)] : parts[static_cast<size_t>(part.parent)]) *
            part.inJoint;
        parts[p].rotation = Normalized(parts[p].rotation);
    }
}

// Computes the poses of the chain's joints; those of its start and end are known.
void SkeletonMapping::PlaceChain(const Chain& chain, std::span<const RelativePose> locals,
                                 std::span<Pose> joints) const {
    const Pose& start = joints[static_cast<size_t>(chain.start)];
    const Pose& goal = joints[static_cast<size_t>(chain.end)];
    Pose led = start;
    for (int joint : chain.joints) {
        led = led * locals[static_cast<size_t>(joint)];
        joints[static_cast<size_t>(joint)] = led;
    }
    led = led * locals[static_cast<size_t>(chain.end)];
    // First the whole chain is rotated about its start; then the remaining error at its end is distributed.
    const Quaternion turn =
        TurnBetween((led.position - start.position).cast<float>(), (goal.position - start.position).cast<float>());
    const auto turned = [&](const Pose& pose) {
        const Vector3 way = (pose.position - start.position).cast<float>();
        return Pose{start.position + Rotate(turn, way).cast<double>(), Normalized(turn * pose.rotation)};
    };
    const Pose end = turned(led);
    const Vector3 stretch = (goal.position - end.position).cast<float>();
    const Vector3 twist = RotationVectorOf(goal.rotation * end.rotation.Conjugate());
    for (size_t i = 0; i < chain.joints.size(); ++i) {
        Pose& pose = joints[static_cast<size_t>(chain.joints[i])];
        pose = turned(pose);
        pose.position += (stretch * chain.fractions[i]).cast<double>();
        pose.rotation = Normalized(RotationFromVector(Vector3(twist * chain.fractions[i])) * pose.rotation);
    }
}

void SkeletonMapping::ToSkeleton(const Pose& origin, std::span<const Pose> parts, std::span<RelativePose> locals,
                                 std::span<Pose> joints) const {
    const DefaultFloats floats;
    FULCRUM_ASSERT(parts.size() == parts_.size() && locals.size() == joints_.size() && joints.size() == joints_.size());
    for (size_t j = 0; j < joints_.size(); ++j) {
        if (joints_[j].part == kNone) continue;
        joints[j] = parts[static_cast<size_t>(joints_[j].part)] * joints_[j].inPart;
        joints[j].rotation = Normalized(joints[j].rotation);
    }
    // In this order, because a chain may start at a joint of an earlier one.
    for (const Chain& chain : chains_) PlaceChain(chain, locals, joints);
    for (size_t j = 0; j < joints_.size(); ++j) {
        const int parent = joints_[j].parent;
        const Pose& frame = parent == kNone ? origin : joints[static_cast<size_t>(parent)];
        if (joints_[j].part != kNone || isInChain_[j]) {
            locals[j] = Normal(Relative(frame, joints[j]));
        } else {
            joints[j] = frame * locals[j];
            joints[j].rotation = Normalized(joints[j].rotation);
        }
    }
}

}  // namespace fulcrum
