#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Random/Calls.h>

namespace fulcrum::testing {

namespace {

void Create(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    RagdollSettings settings = Humanoid();
    settings.parts.resize(2 + values.Below(static_cast<uint32_t>(settings.parts.size()) - 1));
    for (RagdollPart& part : settings.parts) {
        if (values.IsOdd()) part.body.mass = values.Mass();
        if (values.IsOdd()) part.body.linearVelocity = values.Speeds(3);
        if (values.IsOdd()) part.parent = static_cast<int>(values.Below(12));
        if (values.IsOdd()) CommonOf(part.joint).anchorA.point = values.Place(1);
    }
    std::optional<MotionType> motion;
    if (values.Chance(0.3f)) motion = values.One<MotionType>(3);
    const Pose origin{values.Place(3), values.Rotation()};
    const Result<Ragdoll> ragdoll = Ragdoll::Create(*twin.system, settings, origin, motion);
    if (!Note(ragdoll, outcome)) return;
    for (const BodyId id : ragdoll.Value().Bodies()) outcome.answer.Add(id);
    for (const JointId id : ragdoll.Value().Joints()) outcome.answer.Add(id);
    twin.ragdolls[targets.ragdoll] = ragdoll.Value();
    // Its parts are bodies for all other calls, too.
    twin.bodies[targets.bodyA] = ragdoll.Value().Bodies()[values.Below(static_cast<uint32_t>(settings.parts.size()))];
    twin.joints[targets.joint] = ragdoll.Value().Joints()[1];
}

void Remove(Twin& twin, Values&, const CallTargets& targets, Outcome&) {
    if (twin.ragdolls[targets.ragdoll]) twin.ragdolls[targets.ragdoll]->Remove();
}

std::vector<Pose> PoseOf(const Ragdoll& ragdoll, Values& values) {
    const RagdollSettings settings = Humanoid();
    std::vector<Pose> pose(settings.parts.size());
    ReferencePose(settings, {values.Place(2), values.Rotation()}, pose);
    pose.resize(values.IsOdd() ? values.Below(15) : ragdoll.Bodies().size());
    for (Pose& part : pose) {
        if (values.IsOdd()) part = {values.Place(2), values.Rotation()};
    }
    return pose;
}

template <class Change>
void Play(Twin& twin, const CallTargets& targets, Outcome& outcome, const Change& change) {
    if (std::optional<Ragdoll>& ragdoll = twin.ragdolls[targets.ragdoll]) Note(change(*ragdoll), outcome);
}

void SetPose(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    Play(twin, targets, outcome, [&](Ragdoll& ragdoll) { return ragdoll.SetPose(PoseOf(ragdoll, values)); });
}
void DriveByMotors(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    Play(twin, targets, outcome, [&](Ragdoll& ragdoll) { return ragdoll.DriveByMotors(PoseOf(ragdoll, values)); });
}
void DriveByVelocities(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const float dt = values.Setting(0.01f, 1);
    Play(twin, targets, outcome,
         [&](Ragdoll& ragdoll) { return ragdoll.DriveByVelocities(PoseOf(ragdoll, values), dt); });
}
void DriveKinematically(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const float dt = values.Setting(0.01f, 1);
    Play(twin, targets, outcome,
         [&](Ragdoll& ragdoll) { return ragdoll.DriveKinematically(PoseOf(ragdoll, values), dt); });
}
void SetMotors(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    JointMotor motor{.mode = values.One<MotorMode>(3)};
    motor.spring.frequency = values.Setting(1, 10);
    motor.targetSpeed = values.Setting(-2, 2);
    motor.maxForce = values.Setting(10, 1000);
    Play(twin, targets, outcome, [&](Ragdoll& ragdoll) { return ragdoll.SetMotors(motor); });
}
void GetPose(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    Play(twin, targets, outcome, [&](Ragdoll& ragdoll) {
        std::vector<Pose> pose(ragdoll.Bodies().size() + (values.IsOdd() ? 1 : 0));
        const Status status = ragdoll.GetPose(pose);
        for (const Pose& part : pose) outcome.answer.Add(part);
        return status;
    });
}

constexpr CallKind kCalls[] = {
    {"CreateRagdoll", 1, Create},
    {"RemoveRagdoll", 0.2f, Remove},
    {"SetRagdollPose", 0.4f, SetPose},
    {"DriveByMotors", 0.4f, DriveByMotors},
    {"DriveByVelocities", 0.4f, DriveByVelocities},
    {"DriveKinematically", 0.4f, DriveKinematically},
    {"SetRagdollMotors", 0.4f, SetMotors},
    {"GetRagdollPose", 0.2f, GetPose},
};

}  // namespace

std::span<const CallKind> RagdollCalls() { return kCalls; }

}  // namespace fulcrum::testing
