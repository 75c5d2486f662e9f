// Poses of a detailed skeleton mapped to a ragdoll and back.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Ragdoll/SkeletonMapping.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

struct Named {
    const char* name;
    const char* parent;  // null: none
    Position place;      // in the ragdoll's frame
};

// More joints than the ragdoll has parts: a root, a spine of three, collar bones, a neck, fingers, toes.
const Named kJoints[] = {
    {"root", nullptr, {0, -1, 0}},
    {"pelvis", "root", {0, 0, 0}},
    {"spine 1", "pelvis", {0, 0.1, 0.01}},
    {"spine 2", "spine 1", {0, 0.2, 0.02}},
    {"chest", "spine 2", {0, 0.3, 0}},
    {"neck", "chest", {0, 0.5, 0}},
    {"head", "neck", {0, 0.56, 0}},
    {"ear", "head", {0.1, 0.7, 0}},
    {"collar", "chest", {0.05, 0.45, 0}},
    {"upper arm", "collar", {0.24, 0.5, 0}},
    {"elbow twist", "upper arm", {0.24, 0.3, 0}},
    {"lower arm", "elbow twist", {0.24, 0.21, 0}},
    {"hand", "lower arm", {0.24, -0.05, 0}},
    {"finger", "hand", {0.24, -0.1, 0.02}},
    {"thigh", "pelvis", {0.1, -0.06, 0}},
    {"shin", "thigh", {0.1, -0.5, 0}},
    {"toe", "shin", {0.1, -0.95, 0.1}},
};
constexpr size_t kCount = std::size(kJoints);

const SkeletonPair kPairs[] = {
    {"pelvis", "pelvis"},
    {"chest", "torso"},
    {"head", "head"},
    {"upper arm", "upper arm left"},
    {"lower arm", "lower arm left"},
    {"thigh", "upper leg left"},
    {"shin", "lower leg left"},
};

// Every joint turned somehow in the reference pose, so that no rotation is taken for none.
Skeleton MakeSkeleton() {
    Skeleton skeleton;
    std::vector<RelativePose> placed;
    for (size_t i = 0; i < kCount; ++i) {
        int parent = SkeletonJoint::kNoParent;
        for (size_t j = 0; j < i; ++j)
            if (kJoints[i].parent && std::string(kJoints[i].parent) == kJoints[j].name) parent = static_cast<int>(j);
        const auto turn = static_cast<float>(i);
        placed.push_back(
            {kJoints[i].place.cast<float>(), RotationFromVector(Vector3(0.3f * turn, -0.2f * turn, 0.1f))});
        const RelativePose local = parent < 0 ? placed[i] : Inverse(placed[static_cast<size_t>(parent)]) * placed[i];
        skeleton.joints.push_back({kJoints[i].name, parent, {local.position, Normalized(local.rotation)}});
    }
    return skeleton;
}

SkeletonMapping MakeMapping() {
    Result<SkeletonMapping> mapping = SkeletonMapping::Create(MakeSkeleton(), Humanoid(), kPairs);
    EXPECT_TRUE(mapping) << mapping.GetError().message;
    return mapping.Value();
}

size_t IndexOf(const std::string& name) {
    const auto found =
        std::find_if(std::begin(kJoints), std::end(kJoints), [&](const Named& joint) { return name == joint.name; });
    return static_cast<size_t>(found - kJoints);
}

// An animation: every local pose turned, and a little stretched.
std::vector<RelativePose> Animated(const SkeletonMapping& mapping) {
    std::vector<RelativePose> locals(mapping.ReferenceLocals().begin(), mapping.ReferenceLocals().end());
    for (size_t i = 0; i < locals.size(); ++i) {
        const auto turn = static_cast<float>(i % 5) - 2.0f;
        locals[i].rotation =
            Normalized(locals[i].rotation * RotationFromVector(Vector3(0.1f * turn, 0.15f, -0.2f * turn)));
        locals[i].position *= 1.0f + 0.02f * turn;
    }
    return locals;
}

// Of lengths of about a meter, through up to eight products of float rotations: 1e-6 each.
constexpr double kRounding = 1e-5;

void ExpectSame(const Pose& a, const Pose& b, const std::string& what, double tolerance = kRounding) {
    EXPECT_LT((a.position - b.position).norm(), tolerance) << what;
    EXPECT_LT(Length(RotationVectorOf(a.rotation.Conjugate() * b.rotation)), tolerance) << what;
}
void ExpectSame(const RelativePose& a, const RelativePose& b, const std::string& what) {
    ExpectSame(Pose{a.position.cast<double>(), a.rotation}, Pose{b.position.cast<double>(), b.rotation}, what);
}

TEST(SkeletonMapping, TheReferencePoseOfOneIsThatOfTheOther) {
    const SkeletonMapping mapping = MakeMapping();
    const Pose origin{Position(3, 4, 5), RotationAbout(Vector3(0, 1, 0), 1)};
    std::vector<Pose> joints(kCount), parts(12), reference(12);
    mapping.PoseJoints(origin, mapping.ReferenceLocals(), joints);
    mapping.ToRagdoll(joints, parts);
    ReferencePose(Humanoid(), origin, reference);
    for (size_t i = 0; i < 12; ++i) ExpectSame(parts[i], reference[i], Humanoid().parts[i].name);
}

TEST(SkeletonMapping, AnAnimationComesBackWithAllItsDetail) {
    const SkeletonMapping mapping = MakeMapping();
    // Far from the world's origin, too.
    for (const Position& place : {Position(0, 0, 0), Position(1e7, -1e7, 300)}) {
        const Pose origin{place, RotationAbout(Vector3(0, 1, 0), 1)};
        const std::vector<RelativePose> animation = Animated(mapping);
        std::vector<Pose> joints(kCount), parts(12), back(kCount);
        mapping.PoseJoints(origin, animation, joints);
        mapping.ToRagdoll(joints, parts);
        std::vector<RelativePose> locals = animation;
        mapping.ToSkeleton(origin, parts, locals, back);
        for (size_t j = 0; j < kCount; ++j) {
            ExpectSame(back[j], joints[j], kJoints[j].name);
            ExpectSame(locals[j], animation[j], kJoints[j].name);
        }
    }
}

TEST(SkeletonMapping, MappedJointsAreExactFromAnyDetail) {
    const SkeletonMapping mapping = MakeMapping();
    const RagdollSettings humanoid = Humanoid();
    const Pose origin{Position(3, 4, 5), RotationAbout(Vector3(0, 1, 0), 1)};
    std::vector<Pose> parts(12), joints(kCount), again(12), posed(kCount);
    PoseFromJoints(humanoid, {Position(3.5, 4, 5), RotationAbout(Vector3(0, 0, 1), 0.5)}, HumanoidMotion(2), parts);
    std::vector<RelativePose> locals(mapping.ReferenceLocals().begin(), mapping.ReferenceLocals().end());
    mapping.ToSkeleton(origin, parts, locals, joints);
    mapping.PoseJoints(origin, locals, posed);
    for (size_t j = 0; j < kCount; ++j) ExpectSame(posed[j], joints[j], kJoints[j].name);
    mapping.ToRagdoll(posed, again);
    for (const SkeletonPair& pair : kPairs)
        for (size_t i = 0; i < 12; ++i)
            if (humanoid.parts[i].name == pair.part) ExpectSame(again[i], parts[i], pair.part);
    // The root, the ear, the hand, the finger and the toe keep their local poses, as nothing mapped is below them.
    for (const char* name : {"root", "ear", "hand", "finger", "toe"})
        ExpectSame(locals[IndexOf(name)], mapping.ReferenceLocals()[IndexOf(name)], name);
}

TEST(SkeletonMapping, UnmappedPartsFollowTheirParents) {
    const SkeletonMapping mapping = MakeMapping();
    std::vector<Pose> joints(kCount), parts(12), reference(12);
    mapping.PoseJoints({}, Animated(mapping), joints);
    mapping.ToRagdoll(joints, parts);
    ReferencePose(Humanoid(), {}, reference);
    // The right arm hangs on the torso, the foot on the lower leg.
    for (const auto& [part, parent] : {std::pair<size_t, size_t>{4, 1}, {6, 4}, {8, 0}, {10, 8}, {11, 9}})
        ExpectSame(Relative(parts[parent], parts[part]), Relative(reference[parent], reference[part]),
                   Humanoid().parts[part].name);
}

TEST(SkeletonMapping, AChainBendsTowardsItsEndAndStretchesEvenly) {
    // A base, four joints without parts half a meter apart, a hand.
    RagdollSettings ragdoll;
    ragdoll.parts.push_back({.name = "base", .body = {.shape = CubeOf(0.1f)}, .joint = {}});
    ragdoll.parts.push_back(
        {.name = "hand", .parent = 0, .body = {.shape = CubeOf(0.1f), .position = Position(2.5, 0, 0)}, .joint = {}});
    Skeleton skeleton;
    skeleton.joints.push_back({"base", -1, {}});
    for (int i = 1; i <= 4; ++i) skeleton.joints.push_back({"link", i - 1, {Vector3(0.5f, 0, 0), {}}});
    skeleton.joints.push_back({"hand", 4, {Vector3(0.5f, 0, 0), {}}});
    const std::vector<SkeletonPair> pairs = PairsByName(skeleton, ragdoll);
    ASSERT_EQ(pairs.size(), 2u);
    const Result<SkeletonMapping> mapping = SkeletonMapping::Create(skeleton, ragdoll, pairs);
    ASSERT_TRUE(mapping) << mapping.GetError().message;
    const auto jointsFor = [&](const Pose& hand) {
        std::vector<RelativePose> locals(mapping.Value().ReferenceLocals().begin(),
                                         mapping.Value().ReferenceLocals().end());
        std::vector<Pose> joints(6);
        mapping.Value().ToSkeleton({}, std::vector<Pose>{Pose{}, hand}, locals, joints);
        return joints;
    };
    // Turned as a whole: straight still.
    const Quaternion quarter = RotationAbout(Vector3(0, 0, 1), 90 * kDegree);
    std::vector<Pose> joints = jointsFor({Position(0, 2.5, 0), quarter});
    for (int i = 1; i <= 5; ++i)
        ExpectSame(joints[static_cast<size_t>(i)], {Position(0, 0.5 * i, 0), quarter}, std::to_string(i));
    // Stretched, and its end twisted by 1 rad: each link has its share.
    joints = jointsFor({Position(3.0, 0, 0), RotationAbout(Vector3(1, 0, 0), 1.0)});
    for (int i = 1; i <= 5; ++i)
        ExpectSame(joints[static_cast<size_t>(i)], {Position(0.6 * i, 0, 0), RotationAbout(Vector3(1, 0, 0), 0.2 * i)},
                   std::to_string(i));
    // To the opposite side.
    joints = jointsFor({Position(-2.5, 0, 0), RotationAbout(Vector3(0, 1, 0), 180 * kDegree)});
    for (int i = 1; i <= 5; ++i)
        EXPECT_LT((joints[static_cast<size_t>(i)].position - Position(-0.5 * i, 0, 0)).norm(), kRounding);
}

TEST(SkeletonMapping, ErrorsNameJointOrPart) {
    const Skeleton skeleton = MakeSkeleton();
    const auto expect = [](const Skeleton& s, const RagdollSettings& r, std::vector<SkeletonPair> pairs, ErrorCode code,
                           const char* part) {
        const Result<SkeletonMapping> mapping = SkeletonMapping::Create(s, r, pairs);
        ASSERT_FALSE(mapping) << part;
        EXPECT_EQ(mapping.GetError().code, code);
        EXPECT_NE(mapping.GetError().message.find(part), std::string::npos) << mapping.GetError().message;
    };
    const RagdollSettings humanoid = Humanoid();
    using Code = ErrorCode;
    expect(skeleton, humanoid, {}, Code::Unsupported, "\"pelvis\" is in no pair");
    expect(skeleton, humanoid, {{"tail", "pelvis"}}, Code::Unsupported, "no joint has the name \"tail\"");
    expect(skeleton, humanoid, {{"pelvis", "tail"}}, Code::Unsupported, "no part has the name \"tail\"");
    expect(skeleton, humanoid, {{"pelvis", "pelvis"}, {"pelvis", "torso"}}, Code::Unsupported,
           "joint \"pelvis\" is in two");
    expect(skeleton, humanoid, {{"pelvis", "pelvis"}, {"chest", "pelvis"}}, Code::Unsupported,
           "part \"pelvis\" is in two");
    Skeleton wrong = skeleton;
    wrong.joints[3].name = "chest";
    expect(wrong, humanoid, {{"pelvis", "pelvis"}, {"chest", "torso"}}, Code::Unsupported,
           "more than one joint has the name \"chest\"");
    wrong = skeleton;
    wrong.joints[3].parent = 3;
    expect(wrong, humanoid, {}, Code::OutOfRange, "joints[3].parent");
    wrong = skeleton;
    wrong.joints[3].reference.position.x() = std::numeric_limits<float>::infinity();
    expect(wrong, humanoid, {}, Code::NonFinite, "joints[3].reference.position");
    wrong = skeleton;
    wrong.joints[3].reference.rotation = {0, 0, 0, 2};
    expect(wrong, humanoid, {}, Code::Unnormalized, "joints[3].reference.rotation");
    expect(skeleton, {}, {}, Code::Degenerate, "parts is empty");
}

}  // namespace
}  // namespace fulcrum::testing
