#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <array>

namespace fulcrum::RagdollDriveScene {
namespace {

constexpr size_t kParts = 12;
constexpr double kSecondsPerPose = 5.0 / 3;

// In the order of SceneWorld::ragdolls.
enum Driven : size_t { kHanging, kFloating, kByVelocities, kKinematic, kRagdolls };

Pose OriginOf(size_t ragdoll) { return {Position(1.6 * (static_cast<double>(ragdoll) - 1.5), 1.5, 0), {}}; }

std::array<Pose, kParts> TargetAt(size_t ragdoll, double time) {
    const std::array<Quaternion, kParts> rotations = HumanoidMotion(time / kSecondsPerPose);
    static const RagdollSettings humanoid = Humanoid();
    std::array<Pose, kParts> reference, pose;
    ReferencePose(humanoid, OriginOf(ragdoll), reference);
    PoseFromJoints(humanoid, reference[0], rotations, pose);
    return pose;
}

void Build(SceneWorld& world) {
    world.AddFloor(6, 4);
    RagdollSettings hanging = HumanoidWithMotors(2000, 100, 500);
    hanging.parts[0].body.motion = MotionType::Static;
    RagdollSettings floating = HumanoidWithMotors(2000, 100, 500);
    for (RagdollPart& part : floating.parts) part.body.gravityFactor = 0;
    world.AddRagdoll(hanging, OriginOf(kHanging));
    world.AddRagdoll(floating, OriginOf(kFloating));
    world.AddRagdoll(Humanoid(), OriginOf(kByVelocities));
    world.AddRagdoll(Humanoid(), OriginOf(kKinematic), MotionType::Kinematic);
}

void BeforeStep(SceneWorld& world, double dt) {
    if (world.ragdolls.size() < kRagdolls) return;
    const double time = world.Time() + dt;
    const auto seconds = static_cast<float>(dt);
    static_cast<void>(world.ragdolls[kHanging].DriveByMotors(TargetAt(kHanging, time)));
    static_cast<void>(world.ragdolls[kFloating].DriveByMotors(TargetAt(kFloating, time)));
    static_cast<void>(world.ragdolls[kByVelocities].DriveByVelocities(TargetAt(kByVelocities, time), seconds));
    static_cast<void>(world.ragdolls[kKinematic].DriveKinematically(TargetAt(kKinematic, time), seconds));
}

// The largest error of a part's rotation relative to its parent, degrees.
double Accuracy(const SceneWorld& world) {
    const RagdollSettings humanoid = Humanoid();
    double largest = 0;
    for (size_t i = 0; i < kRagdolls; ++i) {
        std::array<Pose, kParts> pose;
        const std::array<Pose, kParts> target = TargetAt(i, world.Time());
        if (!world.ragdolls[i].GetPose(pose)) return 180;
        for (size_t part = 1; part < kParts; ++part) {
            const auto parent = static_cast<size_t>(humanoid.parts[part].parent);
            const Quaternion is = pose[parent].rotation.Conjugate() * pose[part].rotation;
            const Quaternion should = target[parent].rotation.Conjugate() * target[part].rotation;
            largest = std::max<double>(largest, Length(RotationVectorOf(should.Conjugate() * is)));
        }
    }
    return largest / kDegree;
}

}  // namespace

extern const Scene kScene{
    .name = "ragdoll_drive",
    .description =
        "four ragdolls take the same poses: by motors (one hung up, one floating), by velocities, kinematically",
    .steps = 300,
    // All four with their arms and legs wherever the poses put them.
    .view = {.color = ColorMode::Plain,
             .from = {0.35f, 0.2f, 1},
             .lower = {-3.25, 0.1, -0.6},
             .upper = {3.25, 2.35, 0.6},
             .showsJoints = false},
    .build = Build,
    .beforeStep = BeforeStep,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest angle between a joint's rotation and the pose's",
    .accuracyUnit = "degrees",
    .accuracyRange = {{0, 1}},
};

}  // namespace fulcrum::RagdollDriveScene
