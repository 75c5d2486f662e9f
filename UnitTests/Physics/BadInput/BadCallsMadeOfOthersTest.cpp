// Functions that are made of other calls (radial impulses, target joints, water and wind, ragdolls) with bad arguments:
// refused, and no bit has changed.
#include <Fulcrum/Physics/Fields/Fields.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/UnitTests/Physics/BadInput/Room.h>

#include <set>

namespace fulcrum::testing {

template <class Archive>
void Describe(Archive& archive, RadialImpulse& impulse) {
    archive.Field("center", impulse.center);
    archive.Field("radius", impulse.radius);
    archive.Field("impulse", impulse.impulse);
    archive.Choice("falloff", impulse.falloff, std::array{"Constant", "Linear"});
}
template <class Archive>
void Describe(Archive& archive, FieldRegion& region) {
    archive.Field("lower", region.lower);
    archive.Field("upper", region.upper);
}
template <class Archive>
void Describe(Archive& archive, Water& water) {
    archive.Field("region", water.region);
    archive.Field("up", water.up);
    archive.Field("level", water.level);
    archive.Field("density", water.density);
    archive.Field("velocity", water.velocity);
    archive.Field("drag", water.drag);
    archive.Field("angularDrag", water.angularDrag);
}
template <class Archive>
void Describe(Archive& archive, Wind& wind) {
    archive.Field("region", wind.region);
    archive.Field("velocity", wind.velocity);
    archive.Field("density", wind.density);
    archive.Field("dragCoefficient", wind.dragCoefficient);
}
template <class Archive>
void Describe(Archive& archive, ForceField& field) {
    archive.Field("region", field.region);
    archive.Field("acceleration", field.acceleration);
}
template <class Archive>
void Describe(Archive& archive, TargetJointSettings& settings) {
    archive.Field("body", settings.body);
    archive.Field("anchor", settings.anchor);
    archive.Field("target", settings.target);
    archive.Field("spring", settings.spring);
    archive.Field("maxForce", settings.maxForce);
}
template <>
inline constexpr SettingsHeader kSettingsHeader<Water>{"Physics/Fields/Fields.h", "Water"};
template <>
inline constexpr SettingsHeader kSettingsHeader<Wind>{"Physics/Fields/Fields.h", "Wind"};
template <>
inline constexpr SettingsHeader kSettingsHeader<RadialImpulse>{"Physics/BodyInterface.h", "RadialImpulse"};
template <>
inline constexpr SettingsHeader kSettingsHeader<TargetJointSettings>{"Physics/JointInterface.h", "TargetJointSettings"};

namespace {

TEST(BadCallsMadeOfOthers, AreRefusedAndChangeNoBit) {
    Room room;
    BodyInterface& bodies = room.system.Bodies();
    int values = 0;
    values += TryAll<RadialImpulse>(room, "impulse", {.center = {0.2, 0, 0}, .radius = 3, .impulse = 5},
                                    [&](RadialImpulse& s) { return ErrorOf(bodies.AddRadialImpulse(s)); });
    values += TryAll<TargetJointSettings>(
        room, "target", {.body = room.body, .maxForce = 100},
        [&](TargetJointSettings& s) { return ErrorOf(room.system.Joints().CreateTarget(s)); });
    values += TryAll<BodyId>(room, "id", room.body, [&](BodyId& id) {
        return ErrorOf(bodies.SetPose(id, {0, 2, 0}, {}));
    });
    values += TryAll<Pose>(room, "pose", {{0, 2, 0}, {}}, [&](Pose& pose) {
        return ErrorOf(bodies.SetPose(room.body, pose.position, pose.rotation));
    });
    const auto apply = [&](Fields fields, double dt = kStep) { return ErrorOf(fields.Apply(room.system, dt)); };
    values += TryAll<Water>(room, "water", {}, [&](Water& water) { return apply({.waters = {water}}); });
    values += TryAll<Wind>(room, "wind", {.velocity = {3, 0, 0}}, [&](Wind& wind) { return apply({.winds = {wind}}); });
    values += TryAll<ForceField>(room, "force", {.acceleration = {1, 0, 0}},
                                 [&](ForceField& field) { return apply({.forces = {field}}); });
    values += TryAll<double>(room, "dt", kStep, [&](double& dt) { return apply({.waters = {Water{}}}, dt); });
    EXPECT_GT(values, 300);
}

// ---- Ragdolls

RagdollSettings TwoParts() {
    RagdollSettings settings;
    settings.parts.resize(2);
    settings.parts[0].name = "pelvis";
    settings.parts[0].body = {.shape = CapsuleOf(0.2f, 0.1f), .position = {0, 1, 0}};
    settings.parts[1].name = "torso";
    settings.parts[1].parent = 0;
    settings.parts[1].body = {.shape = CapsuleOf(0.2f, 0.1f), .position = {0, 1.6, 0}};
    SwingTwistJointSettings joint;
    joint.anchorA = {.point = {0, 1.3, 0}, .axis = {0, 1, 0}};
    for (AxisControl* const axis : {&joint.twist, &joint.swingY, &joint.swingZ})
        *axis = {.limited = true, .limits = {-0.5f, 0.5f}, .motor = {.mode = MotorMode::ToPosition}};
    settings.parts[1].joint = joint;
    return settings;
}

TEST(BadRagdollCalls, AreAllTried) {
    const std::set<std::string> tried = {
        "Create", "GetPose", "SetPose", "DriveByMotors", "DriveByVelocities", "DriveKinematically", "SetMotors"};
    const std::set<std::string> withoutArguments = {"Remove", "Bodies", "Joints", "Origin"};
    for (const PublicFunction& function : PublicFunctionsOf("Physics/Ragdoll/Ragdoll.h", "Ragdoll"))
        EXPECT_EQ(tried.contains(function.name) + withoutArguments.contains(function.name), 1) << function.name;
}

TEST(BadRagdollCalls, AreRefusedAndChangeNoBit) {
    Room room;
    int values = 0;
    const auto create = [&](const RagdollSettings& settings, const Pose& origin = {}) {
        return ErrorOf(Ragdoll::Create(room.system, settings, origin));
    };
    values += TryAll<Pose>(room, "origin", {{3, 1, 3}, {}}, [&](Pose& origin) { return create(TwoParts(), origin); });
    values += TryAll<BodySettings>(room, "body", TwoParts().parts[1].body, [&](BodySettings& body) {
        RagdollSettings settings = TwoParts();
        settings.parts[1].body = body;
        return create(settings);
    });
    const auto createJoined = [&](SwingTwistJointSettings& joint) {
        RagdollSettings settings = TwoParts();
        settings.parts[1].joint = joint;
        return create(settings);
    };
    values += TryAll<SwingTwistJointSettings>(
        room, "joint", std::get<SwingTwistJointSettings>(TwoParts().parts[1].joint), createJoined, {"bodyA", "bodyB"});
    values += TryAll<MotionType>(room, "motion", MotionType::Kinematic, [&](MotionType& motion) {
        return ErrorOf(Ragdoll::Create(room.system, TwoParts(), {}, motion));
    });

    // One that is there. Its parts move as one would move them.
    for (const MotionType motion : {MotionType::Dynamic, MotionType::Kinematic}) {
        Room with;
        Ragdoll ragdoll = Ragdoll::Create(with.system, TwoParts(), {{-5, 2, 5}, {}}, motion).Value();
        with.Keep();
        using Poses = std::vector<Pose>;
        Poses pose(2);
        ASSERT_TRUE(ragdoll.GetPose(pose));
        values += TryAll<Poses>(with, "pose", pose, [&](Poses& p) { return ErrorOf(ragdoll.SetPose(p)); });
        values += TryAll<Poses>(with, "pose", pose, [&](Poses& p) { return ErrorOf(ragdoll.DriveByMotors(p)); });
        values +=
            TryAll<Poses>(with, "pose", pose, [&](Poses& p) { return ErrorOf(ragdoll.DriveByVelocities(p, 0.1f)); });
        values +=
            TryAll<Poses>(with, "pose", pose, [&](Poses& p) { return ErrorOf(ragdoll.DriveKinematically(p, 0.1f)); });
        values +=
            TryAll<float>(with, "dt", 0.1f, [&](float& dt) { return ErrorOf(ragdoll.DriveByVelocities(pose, dt)); });
        values +=
            TryAll<float>(with, "dt", 0.1f, [&](float& dt) { return ErrorOf(ragdoll.DriveKinematically(pose, dt)); });
        if (motion == MotionType::Dynamic)
            values += TryAll<JointMotor>(with, "motor", {.mode = MotorMode::ToPosition},
                                         [&](JointMotor& motor) { return ErrorOf(ragdoll.SetMotors(motor)); },
                                         {"targetPosition"});
        Poses few(1), many(3);
        for (Poses* const wrong : {&few, &many}) {
            EXPECT_FALSE(ragdoll.GetPose(*wrong));
            EXPECT_FALSE(ragdoll.SetPose(*wrong));
            EXPECT_FALSE(ragdoll.DriveByMotors(*wrong));
            EXPECT_FALSE(ragdoll.DriveByVelocities(*wrong, 0.1f));
            EXPECT_FALSE(ragdoll.DriveKinematically(*wrong, 0.1f));
        }
        EXPECT_EQ(with.system.HashState(), with.Hash());
        ragdoll.Remove();
        ragdoll.Remove();  // again: nothing is left
        EXPECT_FALSE(ragdoll.GetPose(pose));
        EXPECT_FALSE(ragdoll.SetPose(pose));
        EXPECT_FALSE(ragdoll.DriveByVelocities(pose, 0.1f));
    }
    EXPECT_GT(values, 1000);
}

}  // namespace
}  // namespace fulcrum::testing
