// Ragdolls: creation and poses, errors, and how they fall.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Physics/Ragdoll/Stabilize.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

constexpr size_t kParts = 12;

Ragdoll Add(TestWorld& world, const RagdollSettings& settings, const Pose& origin = {}) {
    Result<Ragdoll> ragdoll = Ragdoll::Create(world.System(), settings, origin);
    EXPECT_TRUE(ragdoll) << ragdoll.GetError().message;
    return ragdoll.Value();
}

int BodyCount(TestWorld& world) {
    int count = 0;
    world.System().VisitBodies([&](BodyId) { ++count; });
    return count;
}
int JointCount(TestWorld& world) {
    int count = 0;
    world.System().Joints().Visit([&](JointId) { ++count; });
    return count;
}

double LargestGap(TestWorld& world) {
    double largest = 0;
    const JointInterface& joints = world.System().Joints();
    joints.Visit([&](JointId id) { largest = std::max<double>(largest, joints.GetError(id).distance); });
    return largest;
}

TEST(Ragdoll, StandsWhereItsFrameIsPut) {
    TestWorld world;
    const Pose origin{Position(1e7, -20, 3), RotationAbout(Vector3(0, 1, 0), 90 * kDegree)};
    const Ragdoll ragdoll = Add(world, Humanoid(), origin);
    ASSERT_EQ(ragdoll.Bodies().size(), kParts);
    EXPECT_EQ(BodyCount(world), 12);
    EXPECT_EQ(JointCount(world), 11);
    // A quarter turn about y takes x to -z: the left arm, at x = 0.24, is there.
    const Position arm =
        world.PositionOf(ragdoll.Bodies()[static_cast<size_t>(HumanoidPart::UpperArmLeft)]) - origin.position;
    // Float numbers in the ragdoll's frame, about 1e-7 of a meter.
    EXPECT_LT((arm - Position(0, 0.36, -0.24)).norm(), 1e-6);
    EXPECT_LT(LargestGap(world), 1e-6);
    EXPECT_LT((ragdoll.Origin().position - origin.position).norm(), 1e-6);
    EXPECT_LT(Length(RotationVectorOf(ragdoll.Origin().rotation.Conjugate() * origin.rotation)), 1e-6f);
}

TEST(Ragdoll, AnchorsMayBeGivenInTheRagdollsFrameOrInThatOfTheBodies) {
    const RagdollSettings inRagdoll = Humanoid();
    RagdollSettings inBodies = inRagdoll;
    for (size_t i = 1; i < inBodies.parts.size(); ++i) {
        const RagdollJointFrames frames = JointFramesOf(inRagdoll, i);
        const auto anchor = [](const RelativePose& frame) {
            return JointAnchor{frame.position.cast<double>(), Rotate(frame.rotation, Vector3(1, 0, 0)),
                               Rotate(frame.rotation, Vector3(0, 1, 0))};
        };
        JointSettings& joint = CommonOf(inBodies.parts[i].joint);
        joint.space = JointSpace::Body;
        joint.anchorA = anchor(frames.inParent);
        joint.anchorB = anchor(frames.inPart);
        const RagdollJointFrames again = JointFramesOf(inBodies, i);
        EXPECT_LT(Length(Vector3(again.inPart.position - frames.inPart.position)), 1e-6f);
        EXPECT_LT(Length(RotationVectorOf(again.inPart.rotation.Conjugate() * frames.inPart.rotation)), 1e-6f);
        // Left out, frame B is where frame A is.
        joint.anchorB.reset();
        const RagdollJointFrames without = JointFramesOf(inBodies, i);
        EXPECT_LT(Length(Vector3(without.inPart.position - frames.inPart.position)), 1e-6f);
        EXPECT_LT(Length(RotationVectorOf(without.inPart.rotation.Conjugate() * frames.inPart.rotation)), 1e-6f);
    }
}

TEST(Ragdoll, PosesItsJointsAsTheySayTheyAre) {
    TestWorld world(NoGravity());
    const RagdollSettings settings = Humanoid();
    Ragdoll ragdoll = Add(world, settings);
    std::array<Pose, kParts> pose;
    const std::array<Quaternion, kParts> rotations = HumanoidMotion(1.5);
    PoseFromJoints(settings, {Position(1, 2, 3), RotationAbout(Vector3(0, 0, 1), 1.0)}, rotations, pose);
    ASSERT_TRUE(ragdoll.SetPose(pose));
    EXPECT_LT(LargestGap(world), 1e-6);
    std::array<Pose, kParts> read;
    ASSERT_TRUE(ragdoll.GetPose(read));
    for (size_t i = 0; i < kParts; ++i) EXPECT_LT((read[i].position - pose[i].position).norm(), 1e-12);
    for (size_t i = 1; i < kParts; ++i) {
        const JointInterface& joints = world.System().Joints();
        const JointId id = ragdoll.Joints()[i];
        const Quaternion is = joints.GetFrameA(id).rotation.Conjugate() * joints.GetFrameB(id).rotation;
        EXPECT_LT(Length(RotationVectorOf(rotations[i].Conjugate() * is)), 1e-6f);
    }
}

TEST(Ragdoll, OnlyJoinedPartsPassThroughEachOther) {
    TestWorld world(NoGravity());
    RagdollSettings settings = Humanoid();
    // The head and both upper arms in one place: the arms are joined to the torso, as the head is, not to each other.
    for (size_t part : {2u, 3u, 4u}) settings.parts[part].body.position = Position(0, 0.5, 0);
    const Ragdoll ragdoll = Add(world, settings);
    world.Step();
    int headOnArm = 0, torsoOnOthers = 0;
    world.System().VisitContacts([&](const ContactView& contact) {
        const auto isPair = [&](size_t i, size_t j) {
            const BodyId a = ragdoll.Bodies()[i], b = ragdoll.Bodies()[j];
            return (contact.bodyA == a && contact.bodyB == b) || (contact.bodyA == b && contact.bodyB == a);
        };
        headOnArm += isPair(2, 3) || isPair(2, 4) || isPair(3, 4);
        torsoOnOthers += isPair(1, 0) || isPair(1, 2) || isPair(1, 3) || isPair(1, 4);
    });
    EXPECT_EQ(headOnArm, 3);
    EXPECT_EQ(torsoOnOthers, 0);
}

TEST(Ragdoll, RemovesAllOfItself) {
    TestWorld world;
    const BodyId floor = world.AddFloor();
    Ragdoll ragdoll = Add(world, Humanoid(), {Position(0, 1.1, 0), {}});
    world.Steps(10);
    ragdoll.Remove();
    EXPECT_EQ(BodyCount(world), 1);
    EXPECT_EQ(JointCount(world), 0);
    EXPECT_TRUE(world.Bodies().Exists(floor));
    ragdoll.Remove();  // nothing is left of it
    std::array<Pose, kParts> pose;
    EXPECT_EQ(ragdoll.GetPose(pose).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(ragdoll.DriveByMotors(pose).GetError().code, ErrorCode::UnknownId);
    world.Steps(10);
}

TEST(Ragdoll, PartsThatDoNotMoveAreNotJoinedToEachOther) {
    TestWorld world;
    RagdollSettings settings = Humanoid();
    settings.parts[0].body.motion = MotionType::Kinematic;
    settings.parts[1].body.motion = MotionType::Kinematic;
    const Ragdoll ragdoll = Add(world, settings);
    EXPECT_EQ(JointCount(world), 10);
    EXPECT_FALSE(world.System().Joints().Exists(ragdoll.Joints()[1]));
    const Result<Ragdoll> still =
        Ragdoll::Create(world.System(), settings, {Position(9, 0, 0), {}}, MotionType::Kinematic);
    ASSERT_TRUE(still);
    EXPECT_EQ(JointCount(world), 10);
}

// ---- errors

template <class Change>
void ExpectError(Change&& change, ErrorCode code, const std::string& start, const std::string& part = "") {
    TestWorld world;
    RagdollSettings settings = Humanoid();
    change(settings);
    const Result<Ragdoll> ragdoll = Ragdoll::Create(world.System(), settings);
    ASSERT_FALSE(ragdoll) << start;
    EXPECT_EQ(ragdoll.GetError().code, code) << ragdoll.GetError().message;
    EXPECT_TRUE(ragdoll.GetError().message.starts_with(start)) << ragdoll.GetError().message;
    EXPECT_NE(ragdoll.GetError().message.find(part), std::string::npos) << ragdoll.GetError().message;
    EXPECT_EQ(BodyCount(world), 0);
    EXPECT_EQ(JointCount(world), 0);
}

TEST(RagdollErrors, NamePartAndField) {
    using S = RagdollSettings;
    ExpectError([](S& s) { s.parts.clear(); }, ErrorCode::Degenerate, "parts is empty");
    ExpectError([](S& s) { s.parts[3].name.clear(); }, ErrorCode::Degenerate, "parts[3].name is empty");
    ExpectError([](S& s) { s.parts[3].name = "head"; }, ErrorCode::Degenerate,
                "parts[3].name is \"head\", as that of parts[2]");
    ExpectError([](S& s) { s.parts[0].parent = 0; }, ErrorCode::OutOfRange, "parts[0].parent is 0; it must be -1",
                "pelvis");
    ExpectError([](S& s) { s.parts[5].parent = -1; }, ErrorCode::OutOfRange,
                "parts[5].parent is -1; it must be from 0 to 4", "lower arm left");
    ExpectError([](S& s) { s.parts[5].parent = 5; }, ErrorCode::OutOfRange,
                "parts[5].parent is 5; it must be from 0 to 4", "lower arm left");
    ExpectError([](S& s) { s.parts[1].body.shape = nullptr; }, ErrorCode::Unsupported, "parts[1].body: shape", "torso");
    ExpectError([](S& s) { s.parts[11].body.density = 0; }, ErrorCode::NonPositive, "parts[11].body: density",
                "foot left");
    ExpectError(
        [](S& s) {
            s.parts[2].joint = HingeJointSettings{}, std::get<HingeJointSettings>(s.parts[2].joint).angle.friction = -1;
        },
        ErrorCode::Negative, "parts[2].joint: angle.friction is -1", "head");
    ExpectError([](S& s) { CommonOf(s.parts[7].joint).anchorA.axis.y() = std::numeric_limits<float>::quiet_NaN(); },
                ErrorCode::NonFinite, "parts[7].joint: anchorA.axis", "upper leg left");
}

TEST(RagdollErrors, OfCallsChangeNothing) {
    TestWorld world;
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(Ragdoll::Create(world.System(), Humanoid(), {Position(0, kNaN, 0), {}}).GetError().code,
              ErrorCode::NonFinite);
    EXPECT_EQ(Ragdoll::Create(world.System(), Humanoid(), {Position(0, 0, 0), {1, 1, 1, 1}}).GetError().code,
              ErrorCode::Unnormalized);
    EXPECT_EQ(BodyCount(world), 0);
    Ragdoll ragdoll = Add(world, HumanoidWithMotors(100, 10, 10));
    const uint64_t before = world.System().HashPoses();
    std::array<Pose, kParts> pose;
    ASSERT_TRUE(ragdoll.GetPose(pose));
    for (Pose& part : pose) part.position += Position(1, 0, 0);
    EXPECT_EQ(ragdoll.SetPose(std::span(pose).first(11)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(ragdoll.GetPose(std::span(pose).first(11)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(ragdoll.DriveByVelocities(pose, 0).GetError().code, ErrorCode::NonPositive);
    pose[11].position.x() = kNaN;
    const Status answers[] = {ragdoll.SetPose(pose), ragdoll.DriveByMotors(pose), ragdoll.DriveByVelocities(pose, 0.1f),
                              ragdoll.DriveKinematically(pose, 0.1f)};
    for (const Status& status : answers) {
        ASSERT_FALSE(status);
        EXPECT_EQ(status.GetError().code, ErrorCode::NonFinite);
        EXPECT_TRUE(status.GetError().message.starts_with("pose[11].position")) << status.GetError().message;
    }
    EXPECT_EQ(world.System().HashPoses(), before);
    for (BodyId id : ragdoll.Bodies()) EXPECT_EQ(Length(world.VelocityOf(id)), 0.0f);
    const JointMotor wrong{.mode = MotorMode::ToVelocity, .minForce = 1.0f};
    EXPECT_EQ(ragdoll.SetMotors(wrong).GetError().code, ErrorCode::OutOfRange);
}

// ---- physics

// With a little joint friction, or arms in the air would swing forever.
RagdollSettings WithFriction(RagdollSettings settings, float torque) {
    for (RagdollPart& part : settings.parts) {
        if (auto* hinge = std::get_if<HingeJointSettings>(&part.joint)) hinge->angle.friction = torque;
        if (auto* ball = std::get_if<SwingTwistJointSettings>(&part.joint))
            ball->twist.friction = ball->swingY.friction = ball->swingZ.friction = torque;
    }
    return settings;
}

// The frame's pose in which the ragdoll is turned so and its lowest part this high above the floor.
Pose Above(const RagdollSettings& settings, double x, double z, double height, const Quaternion& turn) {
    std::vector<Pose> pose(settings.parts.size());
    ReferencePose(settings, {Position::Zero(), turn}, pose);
    double lowest = 0;
    for (size_t i = 0; i < pose.size(); ++i)
        lowest = std::min<double>(lowest, pose[i].position.y() - settings.parts[i].body.shape->OuterRadius());
    return {Position(x, height - lowest, z), turn};
}

TEST(Ragdoll, TenFallOnAFloorHoldTogetherAndComeToRest) {
    TestWorld world;
    world.AddFloor({.friction = 0.8f});
    // As made for games: stabilized, and with the effort for their islands that a fall onto a single foot asks for.
    RagdollSettings settings = WithFriction(Humanoid(), 1);
    ASSERT_TRUE(StabilizeMasses(settings, {.smallest = 0.5f, .largest = 1}));
    ASSERT_TRUE(StabilizeInertia(settings));
    for (RagdollPart& part : settings.parts) CommonOf(part.joint).substeps = 8;
    for (int i = 0; i < 10; ++i) {
        const Quaternion turn = RotationAbout(Normalized(Vector3(1, 0.5f * static_cast<float>(i), -1)), 0.6 * i);
        Add(world, settings, Above(settings, 2.5 * (i % 5), 3.0 * (i / 5), 0.2, turn));
    }
    const auto isAwake = [&] {
        bool awake = false;
        world.System().VisitBodies([&](BodyId id) {
            if (world.Bodies().GetMotionType(id) == MotionType::Dynamic) awake = awake || world.Bodies().IsAwake(id);
        });
        return awake;
    };
    double largest = 0;
    int steps = 0;
    while (steps < 900 && isAwake()) {
        world.Step();
        ++steps;
        largest = std::max(largest, LargestGap(world));
    }
    EXPECT_LT(largest, 0.02);
    EXPECT_FALSE(isAwake());
    EXPECT_TRUE(world.AllFinite());
    EXPECT_LT(LargestGap(world), 0.005);
    // Nothing went through the floor: the thinnest part has a radius of 4.5 cm.
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic) {
            EXPECT_GT(world.PositionOf(id).y(), 0.04);
        }
    });
}

}  // namespace
}  // namespace fulcrum::testing
