// A ragdoll in a world: the ids of its bodies and joints, and calls that concern all of them. A plain value: copies
// name the same bodies, which live until Remove. Call it between steps, from one thread at a time, as BodyInterface.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

class Ragdoll {
public:
    // Creates it in the reference pose, with its frame at `origin`. `motion` overrides the motion type of all parts:
    // kinematic for hard keying. Parts connected by a joint do not collide unless JointSettings::collideConnected, all
    // others do. Two parts of which none is dynamic get no joint. The system must outlive the ragdoll's use. Errors:
    // those of Check; of `origin` NonFinite, Unnormalized. On error nothing is created.
    static Result<Ragdoll> Create(PhysicsSystem& system, const RagdollSettings& settings, const Pose& origin = {},
                                  std::optional<MotionType> motion = {});

    // Removes the bodies and joints; those already removed are skipped.
    void Remove();

    // One per part, in the order of the settings.
    std::span<const BodyId> Bodies() const;
    // The joint of each part to its parent; an invalid id for the first part and parts without a joint.
    std::span<const JointId> Joints() const;

    // Spans of poses have one element per part, the pose of the body's own frame. Errors of all functions below:
    // UnknownId (a body was removed), OutOfRange (wrong number of poses), NonFinite, Unnormalized; then nothing has
    // changed.
    Status GetPose(std::span<Pose> pose) const;
    // Teleports the parts; velocities are unchanged.
    Status SetPose(std::span<const Pose> pose);

    // Sets the targets of all position motors to the pose: orientations, and for SixDof joints the positions along
    // their axes. Only relative poses matter, not where the ragdoll is. Motors that are off or drive a speed are
    // unchanged; removed joints are skipped.
    Status DriveByMotors(std::span<const Pose> pose);
    // Soft keying: sets the velocities of all parts such that they reach the pose after `dt` seconds (> 0), gravity
    // included, unless contacts and joints stop them. Errors also: NonPositive, Unsupported (a body is frozen).
    Status DriveByVelocities(std::span<const Pose> pose, float dt);
    // Hard keying: moves the kinematic parts so that they reach the pose after `dt` seconds (> 0); dynamic parts follow
    // by their joints. Errors as for soft keying.
    Status DriveKinematically(std::span<const Pose> pose, float dt);

    // Sets this motor, except its target position, on every angular axis of the ragdoll's joints that can have one.
    // Errors: those of JointInterface::SetMotor.
    Status SetMotors(const JointMotor& motor);

    // The pose of the ragdoll's frame for which the first part's current pose is its reference pose.
    Pose Origin() const;

private:
    explicit Ragdoll(PhysicsSystem& system);
    struct Placed;
    static Placed Place(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion);
    static MaybeError CheckPlaced(const Placed& placed);
    MaybeError Build(const RagdollSettings& settings, const Placed& placed);
    MaybeError CheckExists() const;
    MaybeError CheckPose(std::span<const Pose> pose) const;
    MaybeError CheckDrive(std::span<const Pose> pose, float dt) const;
    Status Drive(std::span<const Pose> pose, float dt, bool dynamicToo);
    // Linear and angular.
    std::pair<Vector3, Vector3> VelocityTo(size_t part, const Pose& pose, float dt) const;
    void SetTarget(JointId joint, const RelativePose& target);

    PhysicsSystem* system_;
    std::vector<BodyId> bodies_;
    std::vector<JointId> joints_;
    std::vector<int> parents_;
    std::vector<RagdollJointFrames> frames_;  // of the joints; the first part's is not used
    std::vector<float> gravityFactors_;
    RelativePose originInRoot_;
};

}  // namespace fulcrum
