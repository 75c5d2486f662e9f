// Ragdolls that follow a pose, by motors, by velocities and kinematically, without external forces on the whole.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

constexpr size_t kParts = 12;

// Parts do not collide with each other: only joints are tested. (The arms overlap the pelvis by 5 mm.)
RagdollSettings WithoutContacts(RagdollSettings settings) {
    for (RagdollPart& part : settings.parts) part.body.layer = 1;
    return settings;
}
SystemSettings NoContacts(SystemSettings settings = {}) {
    settings.layerCollides[1] &= ~2u;
    return settings;
}
constexpr float kStiffness = 2000, kDamping = 100;
RagdollSettings Passive() { return WithoutContacts(Humanoid()); }
RagdollSettings Strong() { return WithoutContacts(HumanoidWithMotors(kStiffness, kDamping, 1000)); }

using Poses = std::array<Pose, kParts>;

Ragdoll Add(TestWorld& world, const RagdollSettings& settings, std::optional<MotionType> motion = {}) {
    Result<Ragdoll> ragdoll = Ragdoll::Create(world.System(), settings, {}, motion);
    EXPECT_TRUE(ragdoll) << ragdoll.GetError().message;
    return ragdoll.Value();
}

Poses PoseAt(double time, const Pose& root = {Position::Zero(), Humanoid().parts[0].body.rotation}) {
    static const RagdollSettings humanoid = Humanoid();
    Poses pose;
    PoseFromJoints(humanoid, root, HumanoidMotion(time), pose);
    return pose;
}

Poses PoseOf(const Ragdoll& ragdoll) {
    Poses pose;
    EXPECT_TRUE(ragdoll.GetPose(pose));
    return pose;
}

// How much a part is turned otherwise against its parent, rad.
double JointAngleError(const RagdollSettings& settings, const Poses& pose, const Poses& target, size_t part) {
    const auto parent = static_cast<size_t>(settings.parts[part].parent);
    const Quaternion is = pose[parent].rotation.Conjugate() * pose[part].rotation;
    const Quaternion should = target[parent].rotation.Conjugate() * target[part].rotation;
    return Length(RotationVectorOf(should.Conjugate() * is));
}

struct Momentum {
    Position linear = Position::Zero(), angular = Position::Zero();  // kg m/s; kg m2/s about the center of mass
    double linearOfParts = 0, angularOfParts = 0;                    // sums of lengths
};
Momentum MomentumOf(TestWorld& world, const Ragdoll& ragdoll) {
    Position center = Position::Zero();
    double mass = 0;
    for (BodyId id : ragdoll.Bodies()) {
        center += world.Bodies().GetMass(id) * world.Bodies().GetCenterOfMass(id);
        mass += world.Bodies().GetMass(id);
    }
    center /= mass;
    Momentum sum;
    for (BodyId id : ragdoll.Bodies()) {
        const Position linear = world.Bodies().GetMass(id) * world.VelocityOf(id).cast<double>();
        const Position arm = world.Bodies().GetCenterOfMass(id) - center;
        const Position angular = world.Bodies().GetAngularMomentum(id).cast<double>() + Cross<double>(arm, linear);
        sum.linear += linear;
        sum.angular += angular;
        sum.linearOfParts += linear.norm();
        sum.angularOfParts += angular.norm();
    }
    return sum;
}

TEST(RagdollDrive, MotorsReachThePoseButForTheirSagUnderTheWeight) {
    TestWorld world(NoContacts());
    RagdollSettings settings = Strong();
    settings.parts[0].body.motion = MotionType::Static;
    Ragdoll ragdoll = Add(world, settings);
    for (double time : {1.0, 2.0, 3.0}) {
        const Poses target = PoseAt(time);
        ASSERT_TRUE(ragdoll.DriveByMotors(target));
        world.Run(2);
        const Poses pose = PoseOf(ragdoll);
        for (size_t i = 1; i < kParts; ++i) {
            // What hangs on the joint pulls with at most its weight times its distance; the spring yields torque /
            // stiffness.
            const Position anchor = world.System().Joints().GetFrameA(ragdoll.Joints()[i]).position;
            double torque = 0;
            for (size_t j = i; j < kParts; ++j) {
                size_t above = j;
                while (above > i) above = static_cast<size_t>(settings.parts[above].parent);
                const Position arm = world.Bodies().GetCenterOfMass(ragdoll.Bodies()[j]) - anchor;
                if (above == i) torque += world.Bodies().GetMass(ragdoll.Bodies()[j]) * kGravity * arm.norm();
            }
            // What the joint locks yields, too. Another 5e-4 for what still swings after 2 s.
            const double yielded = world.System().Joints().GetError(ragdoll.Joints()[i]).angle;
            EXPECT_LT(JointAngleError(settings, pose, target, i), torque / kStiffness + yielded + 5e-4)
                << settings.parts[i].name << " at " << time;
            EXPECT_LT(world.System().Joints().GetError(ragdoll.Joints()[i]).distance, 2e-3) << settings.parts[i].name;
        }
    }
}

TEST(RagdollDrive, MotorsOfAFloatingRagdollReachThePose) {
    TestWorld world(NoContacts(NoGravity()));
    const RagdollSettings settings = Strong();
    Ragdoll ragdoll = Add(world, settings);
    for (double time : {1.0, 2.0, 3.0}) {
        const Poses target = PoseAt(time);
        ASSERT_TRUE(ragdoll.DriveByMotors(target));
        world.Run(2);
        const Poses pose = PoseOf(ragdoll);
        // No load: the springs of time constant c / k = 0.05 s have had 40 of these.
        for (size_t i = 1; i < kParts; ++i)
            EXPECT_LT(JointAngleError(settings, pose, target, i), 1e-3) << settings.parts[i].name << " at " << time;
    }
}

TEST(RagdollDrive, MotorsNeitherMoveNorTurnTheWhole) {
    TestWorld world(NoContacts(NoGravity()));
    Ragdoll ragdoll = Add(world, Strong());
    double linear = 0, angular = 0, linearOfParts = 0, angularOfParts = 0;
    for (int step = 0; step < 360; ++step) {
        ASSERT_TRUE(ragdoll.DriveByMotors(PoseAt(step / 120.0)));
        world.Step();
        const Momentum now = MomentumOf(world, ragdoll);
        linear = std::max(linear, now.linear.norm());
        angular = std::max(angular, now.angular.norm());
        linearOfParts = std::max(linearOfParts, now.linearOfParts);
        angularOfParts = std::max(angularOfParts, now.angularOfParts);
    }
    // Impulses are equal and opposite but for rounding: 360 steps of 4 substeps, each to 1e-7 of what the parts have.
    EXPECT_LT(linear, 2e-4 * linearOfParts);
    // Forces act at arms that are those of the substep's beginning: off by the turn of a substep, 10 rad/s / 240 s at
    // the most, of which opposite motions of left and right take away at least a half.
    EXPECT_LT(angular, 0.02 * angularOfParts);
}

TEST(RagdollDrive, AFallingRagdollDoesNotBeginToSpin) {
    TestWorld world(NoContacts());
    Ragdoll ragdoll = Add(world, Passive());
    world.Run(2);
    const Momentum now = MomentumOf(world, ragdoll);
    EXPECT_LT(now.angular.norm(), 1e-4 * now.linear.norm());  // kg m2/s to kg m/s, of a body of about a meter
    const Poses pose = PoseOf(ragdoll), start = PoseAt(0);
    // It fell freely for 2 s, and nothing else happened to it.
    const double fall = 0.5 * kGravity * 2 * 2;
    for (size_t i = 0; i < kParts; ++i) {
        EXPECT_LT(Length(RotationVectorOf(start[i].rotation.Conjugate() * pose[i].rotation)), 1e-3f);
        EXPECT_NEAR(pose[i].position.y() - start[i].position.y(), -fall, 1e-3);
    }
}

TEST(RagdollDrive, HingeMotorsTakeTheTurnThatIsWithinTheLimits) {
    // The knee of a humanoid bends from 0 to 130 degrees; limits from 200 to 330 degrees hold what is turned by -160 to
    // -30.
    RagdollSettings settings = Strong();
    settings.parts[0].body.motion = MotionType::Static;
    auto& knee = std::get<HingeJointSettings>(settings.parts[9].joint);
    knee.angle.limits.min = static_cast<float>(200 * kDegree);
    knee.angle.limits.max = static_cast<float>(330 * kDegree);
    TestWorld world(NoContacts(NoGravity()));
    Ragdoll ragdoll = Add(world, settings);
    std::array<Quaternion, kParts> rotations{};
    rotations[9] = RotationAbout(Vector3(1, 0, 0), -100 * kDegree);
    Poses target;
    PoseFromJoints(settings, {Position::Zero(), settings.parts[0].body.rotation}, rotations, target);
    ASSERT_TRUE(ragdoll.DriveByMotors(target));
    EXPECT_NEAR(world.System().Joints().GetControl(ragdoll.Joints()[9], JointAxis::AngularX)->motor.targetPosition,
                260 * kDegree, 1e-5);
    world.Run(2);
    EXPECT_LT(JointAngleError(settings, PoseOf(ragdoll), target, 9), 1e-3);
}

TEST(RagdollDrive, SixDofMotorsTakePlaceAndOrientation) {
    RagdollSettings settings;
    settings.parts.push_back(
        {.name = "base", .body = {.shape = CubeOf(0.2f), .motion = MotionType::Static}, .joint = {}});
    SixDofJointSettings joint;
    joint.anchorA.point = Position(1, 0, 0);
    for (AxisControl& axis : joint.axes)
        axis.motor = {.mode = MotorMode::ToPosition, .spring = {.frequency = 4, .dampingRatio = 1}};
    settings.parts.push_back(
        {.name = "hand", .parent = 0, .body = {.shape = CubeOf(0.1f), .position = Position(1, 0, 0)}, .joint = joint});
    TestWorld world(NoContacts(NoGravity()));
    Ragdoll ragdoll = Add(world, settings);
    const std::array<Pose, 2> target{Pose{},
                                     Pose{Position(1.3, 0.2, -0.4), RotationAbout(Normalized(Vector3(1, 2, 3)), 0.8)}};
    ASSERT_TRUE(ragdoll.DriveByMotors(target));
    world.Run(3);
    // Critically damped at 4 Hz: e^-75 of the way is left.
    const Pose hand = world.Bodies().GetPose(ragdoll.Bodies()[1]);
    EXPECT_LT((hand.position - target[1].position).norm(), 1e-4);
    EXPECT_LT(Length(RotationVectorOf(target[1].rotation.Conjugate() * hand.rotation)), 1e-4f);
}

TEST(RagdollDrive, SetMotorsTurnsThemOnAndOff) {
    TestWorld world(NoContacts(NoGravity()));
    Ragdoll ragdoll = Add(world, Passive());
    const RagdollSettings settings = Humanoid();
    const SpringSettings spring{.mode = SpringMode::StiffnessAndDamping, .stiffness = kStiffness, .damping = kDamping};
    ASSERT_TRUE(ragdoll.SetMotors({.mode = MotorMode::ToPosition, .spring = spring}));
    const Poses target = PoseAt(1.0);
    ASSERT_TRUE(ragdoll.DriveByMotors(target));
    world.Run(2);
    EXPECT_LT(JointAngleError(settings, PoseOf(ragdoll), target, 3), 1e-3);
    ASSERT_TRUE(ragdoll.SetMotors({}));
    ASSERT_TRUE(ragdoll.DriveByMotors(PoseAt(2.0)));  // nobody listens
    world.Run(1);
    EXPECT_LT(JointAngleError(settings, PoseOf(ragdoll), target, 3), 1e-3);
}

TEST(RagdollDrive, DrivingByVelocitiesAllocatesNothing) {
    TestWorld world(NoContacts(NoSleep()));
    RagdollSettings settings = Strong();
    settings.parts[0].body.motion = MotionType::Static;
    Ragdoll ragdoll = Add(world, settings);
    std::array<Poses, 60> targets;
    for (size_t i = 0; i < targets.size(); ++i) targets[i] = PoseAt(static_cast<double>(i) / 60);
    for (const Poses& target : targets) {
        ASSERT_TRUE(ragdoll.DriveByMotors(target));
        world.Step();
    }
    const uint64_t before = AllocationCount();
    for (const Poses& target : targets) static_cast<void>(ragdoll.DriveByVelocities(target, 0.1f));
    EXPECT_EQ(AllocationCount(), before);
}

// By r of the anchors and turn in a step: where rotations are chords, anchors part by r turn^2 / 2 on the way, which
// joints take for an error and mend.
TEST(RagdollDrive, VelocitiesReachThePoseInOneStep) {
    for (const SystemSettings& system : {NoContacts(), NoContacts(NoGravity())}) {
        TestWorld world(system);
        Ragdoll ragdoll = Add(world, Passive());
        constexpr double kTurn = 0.1, kArm = 0.3;  // rad, m: about the most of both
        const Poses target = PoseAt(0.1, {Position(0.05, 0.02, -0.03),
                                          RotationAbout(Vector3(0, 1, 0), 0.05) * Humanoid().parts[0].body.rotation});
        const Poses start = PoseAt(0);
        for (size_t i = 0; i < kParts; ++i)
            ASSERT_LT(Length(RotationVectorOf(start[i].rotation.Conjugate() * target[i].rotation)), 0.25) << i;
        ASSERT_TRUE(ragdoll.DriveByVelocities(target, static_cast<float>(kStep)));
        world.Step();
        const Poses pose = PoseOf(ragdoll);
        double place = 0, turn = 0;
        for (size_t i = 0; i < kParts; ++i) {
            place = std::max(place, (pose[i].position - target[i].position).norm());
            turn = std::max<double>(turn, Length(RotationVectorOf(target[i].rotation.Conjugate() * pose[i].rotation)));
        }
        // And g dt h / 2 because joined bodies fall in substeps h.
        EXPECT_LT(place, kArm * kTurn * kTurn / 2 + kGravity * kStep * kStep / 8);
        EXPECT_LT(turn, kTurn * kTurn / 2);
    }
}

TEST(RagdollDrive, VelocitiesFollowAMotionAgainstGravity) {
    TestWorld world(NoContacts());
    Ragdoll ragdoll = Add(world, Passive());
    double largest = 0;
    for (int step = 0; step < 300; ++step) {
        const Poses target = PoseAt((step + 1) / 100.0);
        ASSERT_TRUE(ragdoll.DriveByVelocities(target, static_cast<float>(kStep)));
        world.Step();
        const Poses pose = PoseOf(ragdoll);
        for (size_t i = 0; i < kParts; ++i) largest = std::max(largest, (pose[i].position - target[i].position).norm());
    }
    EXPECT_LT(largest, 1e-3);
}

TEST(RagdollDrive, KinematicPartsFollowExactly) {
    TestWorld world(NoContacts());
    Ragdoll ragdoll = Add(world, Passive(), MotionType::Kinematic);
    for (int step = 0; step < 300; ++step) {
        const double time = (step + 1) / 100.0;
        const Quaternion turn = RotationAbout(Vector3(0, 1, 0), time) * Humanoid().parts[0].body.rotation;
        const Poses target = PoseAt(time, {Position(time, 0.1 * time * time, 0), turn});
        ASSERT_TRUE(ragdoll.DriveKinematically(target, static_cast<float>(kStep)));
        world.Step();
        const Poses pose = PoseOf(ragdoll);
        for (size_t i = 0; i < kParts; ++i) {
            // Velocities are floats: 1e-7 of the way of a step, and of the turn.
            ASSERT_LT((pose[i].position - target[i].position).norm(), 1e-7) << i;
            ASSERT_LT(Length(RotationVectorOf(target[i].rotation.Conjugate() * pose[i].rotation)), 1e-6f) << i;
        }
    }
}

TEST(RagdollDrive, DynamicPartsHangOnKinematicOnes) {
    TestWorld world(NoContacts());
    RagdollSettings settings = Passive();
    settings.parts[0].body.motion = MotionType::Kinematic;
    settings.parts[1].body.motion = MotionType::Kinematic;
    Ragdoll ragdoll = Add(world, settings);
    for (int step = 0; step < 240; ++step) {
        const Poses target = PoseAt(0, {Position(step / 120.0, 0, 0), settings.parts[0].body.rotation});
        ASSERT_TRUE(ragdoll.DriveKinematically(target, static_cast<float>(kStep)));
        world.Step();
        for (size_t i = 2; i < kParts; ++i)
            ASSERT_LT(world.System().Joints().GetError(ragdoll.Joints()[i]).distance, 5e-3);
    }
    // Carried along, and below.
    const Poses pose = PoseOf(ragdoll);
    EXPECT_NEAR(pose[0].position.x(), 239 / 120.0, 1e-5);
    EXPECT_NEAR(pose[9].position.x(), 239 / 120.0, 0.9);
    EXPECT_LT(pose[9].position.y(), -0.3);
}

}  // namespace
}  // namespace fulcrum::testing
